#pragma once

#include <functional>

#include <QString>

class QWidget;

namespace isoslider::widgets {

/// How the window asks for file names. Answers come later, on the window's thread; a cancelled
/// dialog never answers. Tests answer beforehand.
class FileDialogs {
public:
    using Chosen = std::function<void(const QString& path)>;

    virtual ~FileDialogs() = default;
    virtual void askOpen(QWidget* parent, const QString& title, const QString& folder, const QString& filters,
                         Chosen chosen) = 0;
    virtual void askFolder(QWidget* parent, const QString& title, const QString& folder, Chosen chosen) = 0;
    /// `suggestion` is a whole path. A name without suffix gets the one of the chosen filter.
    virtual void askSave(QWidget* parent, const QString& title, const QString& suggestion, const QString& filters,
                         Chosen chosen) = 0;
};

/// The platform's dialogs, without a nested event loop.
class PlatformFileDialogs final : public FileDialogs {
public:
    void askOpen(QWidget* parent, const QString& title, const QString& folder, const QString& filters,
                 Chosen chosen) override;
    void askFolder(QWidget* parent, const QString& title, const QString& folder, Chosen chosen) override;
    void askSave(QWidget* parent, const QString& title, const QString& suggestion, const QString& filters,
                 Chosen chosen) override;
};

} // namespace isoslider::widgets
