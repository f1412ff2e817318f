#pragma once

#include <memory>

#include <QByteArray>
#include <QHash>
#include <QString>
#include <QStringList>
#include <QVariant>

namespace isoslider::widgets {

/// What the program remembers between runs: the one door to the settings file. Keys, types,
/// defaults and domains are declared in resources/settings.json; asking for an undeclared key is a
/// programmer error. A stored value outside its domain reads as the default.
/// Values are read once, at the start; what is set is written and synced by a thread of the store's own, which
/// destruction waits for.
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

private:
    struct Declarations;
    class Writer;
    QVariant valueOf(const char* key) const { return values_.value(QLatin1String(key)); }
    void store(const char* key, const char* type, const QVariant& value);

    std::unique_ptr<Declarations> declarations_;
    QHash<QString, QVariant> values_;
    std::unique_ptr<Writer> writer_;
};

} // namespace isoslider::widgets
