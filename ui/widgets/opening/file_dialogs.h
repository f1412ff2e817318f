#pragma once

#include <functional>

#include <QSize>
#include <QString>

#include "ui/widgets/viewport/picture_choice.h"

class QWidget;

namespace isoslider::widgets {

/// How the window asks for file names, and for what pictures are to be like. Answers come later, on the window's
/// thread; a cancelled dialog never answers. Tests answer beforehand.
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
    /// How a picture of a view of so many pixels is to be; `last`: as it was asked for before.
    virtual void askPicture(QWidget* parent, const PictureChoice& last, QSize view,
                            std::function<void(const PictureChoice&)> chosen) = 0;
};

/// The platform's dialogs, without a nested event loop.
class PlatformFileDialogs final : public FileDialogs {
public:
    void askOpen(QWidget* parent, const QString& title, const QString& folder, const QString& filters,
                 Chosen chosen) override;
    void askFolder(QWidget* parent, const QString& title, const QString& folder, Chosen chosen) override;
    void askSave(QWidget* parent, const QString& title, const QString& suggestion, const QString& filters,
                 Chosen chosen) override;
    void askPicture(QWidget* parent, const PictureChoice& last, QSize view,
                    std::function<void(const PictureChoice&)> chosen) override;
};

} // namespace isoslider::widgets
