#include "ui/widgets/viewport/picture_file.h"

#include <chrono>
#include <optional>

#include <QBuffer>
#include <QByteArray>
#include <QImageWriter>
#include <QPainter>

#include "core/base/file_system.h"
#include "ui/render/picture_order.h"
#include "ui/widgets/viewport/picture_halo.h"

namespace isoslider::widgets {

Status writePicture(const QImage& picture, const std::filesystem::path& path) {
    const auto suffix = path.extension().string();
    QByteArray bytes;
    QBuffer buffer(&bytes);
    QImageWriter writer(&buffer, QByteArray::fromStdString(suffix.empty() ? suffix : suffix.substr(1)));
    if (!writer.canWrite())
        return makeError(ErrorCode::InvalidArgument, "is not the name of a picture; end it in .png", path.string());
    if (picture.hasAlphaChannel() && suffix != ".png" && suffix != ".PNG")
        return makeError(ErrorCode::InvalidArgument, "a picture without a background is a PNG; end its name in .png",
                         path.string());
    if (!writer.write(picture))
        return makeError(ErrorCode::OutOfSpace, "the picture could not be encoded", path.string());
    return writeWholeFile(path, std::string_view(bytes.constData(), static_cast<std::size_t>(bytes.size())));
}

Status writeOrdered(const ViewportHost::OrderedPicture& ordered, const std::filesystem::path& path,
                    const JobControl& job) {
    constexpr std::chrono::milliseconds kLook(20);
    constexpr double kDrawing = 0.9; // of the whole
    std::optional<QImage> picture;
    while (!picture) {
        picture = ordered.scene->waitFor(kLook);
        if (!picture && job.isStopRequested()) {
            ordered.scene->cancel();
            return cancelledError();
        }
        job.report(kDrawing * ordered.scene->fraction(), "drawing");
    }
    if (picture->isNull())
        return makeError(ErrorCode::IoError, "the graphics card could not draw the picture", path.string());
    QPainter(&*picture).drawImage(
        0, 0, ordered.halo.isValid() ? withHalo(ordered.above, ordered.halo, ordered.haloPixels) : ordered.above);
    job.report(kDrawing, "writing");
    return writePicture(*picture, path);
}

} // namespace isoslider::widgets
