#pragma once

#include <memory>

#include <QByteArray>
#include <QString>
#include <QStringList>

class QSettings;

namespace isoslider::widgets {

/// What the program remembers between runs: the one door to the settings file. Keys, types,
/// defaults and domains are declared in resources/settings.json; asking for an undeclared key is a
/// programmer error. A stored value outside its domain reads as the default.
class SettingsStore {
public:
    /// The user's own settings file, where the platform keeps such files.
    SettingsStore();
    /// A settings file at a path, for tests.
    explicit SettingsStore(const QString& filePath);
    ~SettingsStore();

    bool boolean(const char* key) const;
    double number(const char* key) const;
    QString text(const char* key) const;
    QStringList list(const char* key) const;
    QByteArray bytes(const char* key) const;

    void set(const char* key, bool value);
    void set(const char* key, double value);
    void set(const char* key, const QString& value);
    void set(const char* key, const QStringList& value);
    void set(const char* key, const QByteArray& value);
    void remove(const char* key);

private:
    struct Declarations;
    std::unique_ptr<QSettings> settings_;
    std::unique_ptr<Declarations> declarations_;
};

} // namespace isoslider::widgets
