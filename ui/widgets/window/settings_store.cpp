#include "ui/widgets/window/settings_store.h"

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include <QFile>
#include <QHash>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QSettings>
#include <QVariant>

#include "core/base/check.h"

namespace isoslider::widgets {

struct SettingsStore::Declarations {
    QHash<QString, QJsonObject> byKey;

    Declarations() {
        QFile file(QStringLiteral(":/isoslider/settings.json"));
        ISO_CHECK(file.open(QIODevice::ReadOnly));
        const auto all = QJsonDocument::fromJson(file.readAll()).object();
        for (const auto& entry : all[QStringLiteral("settings")].toArray())
            byKey.insert(entry.toObject()[QStringLiteral("key")].toString(), entry.toObject());
    }

    QJsonObject of(const char* key, const char* type) const {
        const auto found = byKey.constFind(QLatin1String(key));
        ISO_CHECK(found != byKey.constEnd());
        ISO_CHECK((*found)[QStringLiteral("type")].toString() == QLatin1String(type));
        return *found;
    }
};

/// Writes what is set, the newest value of each key, and waits for the disk: a slow one must not hold up the window.
class SettingsStore::Writer {
public:
    /// `filePath` empty: the user's own file.
    explicit Writer(QString filePath)
        : filePath_(std::move(filePath)), thread_([this](std::stop_token stop) { loop(stop); }) {}

    void write(const QString& key, const QVariant& value) {
        {
            const std::lock_guard lock(mutex_);
            pending_.insert(key, value);
        }
        wake_.notify_one();
    }

    static std::unique_ptr<QSettings> open(const QString& filePath) {
        if (filePath.isEmpty())
            return std::make_unique<QSettings>(QSettings::IniFormat, QSettings::UserScope, QStringLiteral("isoslider"),
                                               QStringLiteral("isoslider"));
        return std::make_unique<QSettings>(filePath, QSettings::IniFormat);
    }

private:
    void loop(std::stop_token stop) {
        const auto settings = open(filePath_);
        for (auto values = take(stop); !values.isEmpty(); values = take(stop)) {
            for (auto entry = values.cbegin(); entry != values.cend(); ++entry)
                settings->setValue(entry.key(), entry.value());
            settings->sync();
        }
    }
    /// Empty when all is written and the store goes.
    QHash<QString, QVariant> take(std::stop_token stop) {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, stop, [this] { return !pending_.isEmpty(); });
        return std::exchange(pending_, {});
    }

    QString filePath_;
    std::mutex mutex_;
    std::condition_variable_any wake_;
    QHash<QString, QVariant> pending_;
    std::jthread thread_; // last: joins before the members above go
};

SettingsStore::SettingsStore() : SettingsStore(QString()) {}

SettingsStore::SettingsStore(const QString& filePath) : declarations_(std::make_unique<Declarations>()) {
    const auto settings = Writer::open(filePath);
    for (const QString& key : declarations_->byKey.keys())
        if (settings->contains(key))
            values_.insert(key, settings->value(key));
    writer_ = std::make_unique<Writer>(filePath);
}

SettingsStore::~SettingsStore() = default;

void SettingsStore::store(const char* key, const char* type, const QVariant& value) {
    declarations_->of(key, type);
    if (valueOf(key) == value)
        return;
    values_.insert(QLatin1String(key), value);
    writer_->write(QLatin1String(key), value);
}

bool SettingsStore::boolean(const char* key) const {
    const auto declared = declarations_->of(key, "bool");
    const QString stored = valueOf(key).toString();
    if (stored == QLatin1String("true") || stored == QLatin1String("false"))
        return stored == QLatin1String("true");
    return declared[QStringLiteral("default")].toBool();
}

double SettingsStore::number(const char* key) const {
    const auto declared = declarations_->of(key, "number");
    bool isNumber = false;
    const double stored = valueOf(key).toDouble(&isNumber);
    const bool isInDomain = isNumber && stored >= declared[QStringLiteral("min")].toDouble() &&
                            stored <= declared[QStringLiteral("max")].toDouble();
    return isInDomain ? stored : declared[QStringLiteral("default")].toDouble();
}

QString SettingsStore::text(const char* key) const {
    const auto declared = declarations_->of(key, "text");
    const QString byDefault = declared[QStringLiteral("default")].toString();
    const QString stored = values_.value(QLatin1String(key), byDefault).toString();
    const auto domain = declared[QStringLiteral("values")].toArray();
    return domain.isEmpty() || domain.contains(stored) ? stored : byDefault;
}

QStringList SettingsStore::list(const char* key) const {
    declarations_->of(key, "list");
    return valueOf(key).toStringList();
}

QByteArray SettingsStore::bytes(const char* key) const {
    declarations_->of(key, "bytes");
    return valueOf(key).toByteArray();
}

void SettingsStore::set(const char* key, bool value) { store(key, "bool", value); }

void SettingsStore::set(const char* key, double value) { store(key, "number", value); }

void SettingsStore::set(const char* key, const QString& value) { store(key, "text", value); }

void SettingsStore::set(const char* key, const QStringList& value) { store(key, "list", value); }

void SettingsStore::set(const char* key, const QByteArray& value) { store(key, "bytes", value); }

} // namespace isoslider::widgets
