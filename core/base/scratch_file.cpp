#include "core/base/scratch_file.h"

namespace isoslider {

Status ScratchFile::create() {
    auto out = fileSystem_.create(path_);
    if (!out.isOk())
        return std::move(out).error();
    auto in = fileSystem_.openForReading(path_);
    Status removed = fileSystem_.removeFile(path_); // open files stay readable and writable without a name
    if (in.isOk() && removed.isOk()) {
        in_ = std::move(in).value();
        out_ = std::move(out).value();
        return {};
    }
    Status problem = in.isOk() ? std::move(removed) : Status(in.error());
    in = Error();
    out = Error();
    (void)fileSystem_.removeFile(path_); // some systems do so with closed files only
    return problem;
}

Status ScratchFile::begin() {
    const std::lock_guard lock(mutex_);
    return out_ ? Status() : create();
}

Result<std::uint64_t> ScratchFile::append(std::span<const std::byte> bytes) {
    const std::lock_guard lock(mutex_);
    if (!out_)
        ISO_TRY(create());
    const std::uint64_t offset = out_->sizeBytes();
    ISO_TRY(out_->writeAll(bytes));
    return offset;
}

Status ScratchFile::readAt(std::uint64_t offset, std::span<std::byte> out) const {
    return in_->readExactlyAt(offset, out);
}

std::uint64_t ScratchFile::sizeBytes() const {
    const std::lock_guard lock(mutex_);
    return out_ ? out_->sizeBytes() : 0;
}

} // namespace isoslider
