#include "ui/widgets/viewport/picture_file.h"

#include <QBuffer>
#include <QByteArray>
#include <QImageWriter>

#include "core/base/file_system.h"

namespace isoslider::widgets {

Status writePicture(const QImage& picture, const std::filesystem::path& path) {
    const auto suffix = path.extension().string();
    QByteArray bytes;
    QBuffer buffer(&bytes);
    QImageWriter writer(&buffer, QByteArray::fromStdString(suffix.empty() ? suffix : suffix.substr(1)));
    if (!writer.canWrite())
        return makeError(ErrorCode::InvalidArgument, "is not the name of a picture; end it in .png", path.string());
    if (!writer.write(picture))
        return makeError(ErrorCode::OutOfSpace, "the picture could not be encoded", path.string());
    return writeWholeFile(path, std::string_view(bytes.constData(), static_cast<std::size_t>(bytes.size())));
}

} // namespace isoslider::widgets
