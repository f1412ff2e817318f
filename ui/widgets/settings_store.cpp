#include "ui/widgets/settings_store.h"

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

SettingsStore::SettingsStore()
    : settings_(std::make_unique<QSettings>(QSettings::IniFormat, QSettings::UserScope,
                                            QStringLiteral("isoslider"), QStringLiteral("isoslider"))),
      declarations_(std::make_unique<Declarations>()) {}

SettingsStore::SettingsStore(const QString& filePath)
    : settings_(std::make_unique<QSettings>(filePath, QSettings::IniFormat)),
      declarations_(std::make_unique<Declarations>()) {}

SettingsStore::~SettingsStore() = default;

bool SettingsStore::boolean(const char* key) const {
    const auto declared = declarations_->of(key, "bool");
    const QString stored = settings_->value(QLatin1String(key)).toString();
    if (stored == QLatin1String("true") || stored == QLatin1String("false"))
        return stored == QLatin1String("true");
    return declared[QStringLiteral("default")].toBool();
}

double SettingsStore::number(const char* key) const {
    const auto declared = declarations_->of(key, "number");
    bool isNumber = false;
    const double stored = settings_->value(QLatin1String(key)).toDouble(&isNumber);
    const bool isInDomain = isNumber && stored >= declared[QStringLiteral("min")].toDouble() &&
                            stored <= declared[QStringLiteral("max")].toDouble();
    return isInDomain ? stored : declared[QStringLiteral("default")].toDouble();
}

QString SettingsStore::text(const char* key) const {
    const auto declared = declarations_->of(key, "text");
    const QString byDefault = declared[QStringLiteral("default")].toString();
    const QString stored = settings_->value(QLatin1String(key), byDefault).toString();
    const auto domain = declared[QStringLiteral("values")].toArray();
    return domain.isEmpty() || domain.contains(stored) ? stored : byDefault;
}

QStringList SettingsStore::list(const char* key) const {
    declarations_->of(key, "list");
    return settings_->value(QLatin1String(key)).toStringList();
}

QByteArray SettingsStore::bytes(const char* key) const {
    declarations_->of(key, "bytes");
    return settings_->value(QLatin1String(key)).toByteArray();
}

void SettingsStore::set(const char* key, bool value) {
    declarations_->of(key, "bool");
    settings_->setValue(QLatin1String(key), value);
}

void SettingsStore::set(const char* key, double value) {
    declarations_->of(key, "number");
    settings_->setValue(QLatin1String(key), value);
}

void SettingsStore::set(const char* key, const QString& value) {
    declarations_->of(key, "text");
    settings_->setValue(QLatin1String(key), value);
}

void SettingsStore::set(const char* key, const QStringList& value) {
    declarations_->of(key, "list");
    settings_->setValue(QLatin1String(key), value);
}

void SettingsStore::set(const char* key, const QByteArray& value) {
    declarations_->of(key, "bytes");
    settings_->setValue(QLatin1String(key), value);
}

void SettingsStore::remove(const char* key) { settings_->remove(QLatin1String(key)); }

} // namespace isoslider::widgets
