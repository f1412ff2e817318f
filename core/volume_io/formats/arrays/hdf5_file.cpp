#include "core/volume_io/formats/arrays/hdf5_file.h"

#include <algorithm>
#include <set>

#include "core/volume_io/parsing/header_checks.h"

namespace isoslider::io {
namespace {

constexpr std::size_t kMaxDepth = 64;
constexpr std::size_t kMaxPath = 4000;
constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kMaxCacheBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kMaxPacking = 8000; ///< deflate packs 1032 to 1 at most, others less or rarely more
constexpr hsize_t kMaxAttributeValues = 64;

std::mutex& oneAtATime() {
    static std::mutex mutex;
    return mutex;
}

herr_t keepInnermost(unsigned, const H5E_error2_t* error, void* text) {
    auto& kept = *static_cast<std::string*>(text);
    if (kept.empty() && error->desc != nullptr)
        kept = error->desc;
    return 0;
}

std::vector<std::uint64_t> extentsOf(hid_t space) {
    const int rank = H5Sget_simple_extent_ndims(space);
    std::vector<hsize_t> sizes(static_cast<std::size_t>(std::max(rank, 0)));
    if (rank > 0)
        H5Sget_simple_extent_dims(space, sizes.data(), nullptr);
    return {sizes.begin(), sizes.end()};
}

/// Reports what keeps samples of this type from being read, or sets `type`.
std::string checkType(hid_t file, FileType& type) {
    const H5T_class_t kind = H5Tget_class(file);
    const std::size_t size = H5Tget_size(file);
    if (kind == H5T_FLOAT && size <= 8) {
        type = size <= 4 ? FileType::F32 : FileType::F64; // halves become f32
        return {};
    }
    if (kind == H5T_INTEGER && (size == 1 || size == 2 || size == 4 || size == 8)) {
        constexpr FileType kSigned[] = {FileType::I8, FileType::I16, FileType::I32, FileType::I64};
        constexpr FileType kUnsigned[] = {FileType::U8, FileType::U16, FileType::U32, FileType::U64};
        const std::size_t index = size == 1 ? 0 : size == 2 ? 1 : size == 4 ? 2 : 3;
        type = (H5Tget_sign(file) == H5T_SGN_NONE ? kUnsigned : kSigned)[index];
        return {};
    }
    if (kind == H5T_COMPOUND)
        return "its samples are records of several values";
    return "its samples are no numbers of a known type";
}

class TreeWalk {
public:
    Hdf5Tree run(hid_t file) {
        Hdf5Handle root(H5Gopen2(file, "/", H5P_DEFAULT), H5Gclose);
        if (root.isOpen())
            enter(root.id(), "");
        return std::move(tree_);
    }

private:
    struct Listing {
        std::vector<std::string> names;
        bool isCut = false;
    };

    // Called by the library, which is C: nothing may be thrown through it.
    static herr_t keepName(hid_t, const char* name, const H5L_info_t* info, void* data) {
        auto& listing = *static_cast<Listing*>(data);
        if (info->type != H5L_TYPE_HARD)
            return 0;
        if (listing.names.size() >= kMaxObjects) {
            listing.isCut = true;
            return 1;
        }
        try {
            listing.names.emplace_back(name);
        } catch (...) {
            return -1;
        }
        return 0;
    }

    void enter(hid_t group, const std::string& path) {
        H5O_info_t info;
        if (H5Oget_info2(group, &info, H5O_INFO_BASIC) < 0 || !seen_.insert(info.addr).second)
            return;
        if (++depth_ > kMaxDepth || path.size() > kMaxPath) {
            tree_.isCut = true;
        } else {
            Listing listing;
            hsize_t at = 0;
            if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, &at, keepName, &listing) < 0 || listing.isCut)
                tree_.isCut = true;
            for (const std::string& name : listing.names)
                visit(group, name, path + "/" + name);
        }
        --depth_;
    }

    void visit(hid_t group, const std::string& name, const std::string& path) {
        if (++objects_ > kMaxObjects) {
            tree_.isCut = true;
            return;
        }
        const Hdf5Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose);
        if (!object.isOpen())
            return;
        const H5I_type_t kind = H5Iget_type(object.id());
        if (kind == H5I_GROUP)
            enter(object.id(), path);
        else if (kind == H5I_DATASET)
            add(object.id(), path);
    }

    void add(hid_t dataset, const std::string& path) {
        H5O_info_t info;
        if (H5Oget_info2(dataset, &info, H5O_INFO_BASIC) < 0 || !seen_.insert(info.addr).second)
            return;
        const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
        const Hdf5Handle type(H5Dget_type(dataset), H5Tclose);
        if (!space.isOpen() || !type.isOpen() || H5Sget_simple_extent_type(space.id()) != H5S_SIMPLE)
            return;
        Hdf5Dataset found;
        found.path = path;
        found.extents = extentsOf(space.id());
        if (found.extents.size() < 2 || found.extents.size() > 4 || H5Tget_class(type.id()) == H5T_STRING)
            return;
        found.problem = checkType(type.id(), found.type);
        tree_.datasets.push_back(std::move(found));
    }

    Hdf5Tree tree_;
    std::set<haddr_t> seen_;
    std::size_t depth_ = 0, objects_ = 0;
};

class StorageCheck {
public:
    StorageCheck(const Hdf5Session& session, hid_t dataset, std::string_view name, const std::filesystem::path& path,
                 std::uint64_t fileBytes)
        : session_(session),
          dataset_(dataset),
          name_(inQuotes(name)),
          path_(path),
          fileBytes_(fileBytes),
          space_(H5Dget_space(dataset), H5Sclose),
          type_(H5Dget_type(dataset), H5Tclose),
          settings_(H5Dget_create_plist(dataset), H5Pclose) {}

    Status run() const {
        if (!space_.isOpen() || !type_.isOpen() || !settings_.isOpen())
            return session_.error(name_ + " cannot be opened", path_);
        ISO_TRY(checkFilters());
        switch (H5Pget_layout(settings_.id())) {
            case H5D_COMPACT: return {};
            case H5D_CONTIGUOUS: return checkContiguous();
            case H5D_CHUNKED: return checkChunks();
            case H5D_VIRTUAL: return refuseField(name_, "its samples lie in other files", path_);
            default: return refuseField(name_, "its samples are stored in no known way", path_);
        }
    }

private:
    Status checkFilters() const {
        for (int i = 0; i < H5Pget_nfilters(settings_.id()); ++i) {
            unsigned flags = 0, config = 0;
            std::size_t count = 0;
            char filterName[64] = "";
            const H5Z_filter_t filter = H5Pget_filter2(settings_.id(), static_cast<unsigned>(i), &flags, &count,
                                                       nullptr, sizeof filterName - 1, filterName, &config);
            if (H5Zfilter_avail(filter) <= 0)
                return refuseField(name_,
                                   "it is packed with filter " + std::to_string(filter) + " " + inQuotes(filterName) +
                                       ", which is not installed",
                                   path_);
        }
        return {};
    }

    Error unwritten() const { return refuseField(name_, "its samples were never written", path_); }

    Status checkContiguous() const {
        if (H5Pget_external_count(settings_.id()) > 0)
            return refuseField(name_, "its samples lie in other files", path_);
        const std::uint64_t stored = H5Dget_storage_size(dataset_);
        const haddr_t offset = H5Dget_offset(dataset_);
        if (stored == 0 || offset == HADDR_UNDEF)
            return unwritten();
        std::uint64_t expected = H5Tget_size(type_.id());
        for (const std::uint64_t extent : extentsOf(space_.id()))
            expected = extent != 0 && expected > UINT64_MAX / extent ? UINT64_MAX : expected * extent;
        if (expected != stored || offset > fileBytes_ || stored > fileBytes_ - offset)
            return makeError(ErrorCode::Corruption,
                             name_ + ": needs " + std::to_string(expected) + " bytes from " + std::to_string(offset) +
                                 " on, the file has only " + std::to_string(fileBytes_),
                             path_, offset);
        return {};
    }

    Status checkChunks() const {
        std::vector<hsize_t> sizes(8, 1);
        const int rank = H5Pget_chunk(settings_.id(), static_cast<int>(sizes.size()), sizes.data());
        std::uint64_t chunkBytes = H5Tget_size(type_.id());
        for (int i = 0; i < rank; ++i)
            chunkBytes *= std::min<hsize_t>(sizes[static_cast<std::size_t>(i)], std::uint64_t{1} << 32);
        if (rank < 1 || chunkBytes == 0 || chunkBytes > kMaxChunkBytes)
            return refuseField(name_,
                               "its chunks are of " + std::to_string(chunkBytes >> 20) + " MiB each; up to " +
                                   std::to_string(kMaxChunkBytes >> 20) + " are read",
                               path_);
        hsize_t chunks = 0;
        if (H5Dget_num_chunks(dataset_, space_.id(), &chunks) < 0)
            return session_.error(name_ + ": its list of chunks is damaged", path_);
        const std::uint64_t stored = H5Dget_storage_size(dataset_);
        if (chunks == 0 || stored == 0)
            return unwritten();
        if (stored > fileBytes_ || chunks > kMaxPacking * (stored / chunkBytes + 1))
            return makeError(ErrorCode::Corruption,
                             name_ + ": " + std::to_string(chunks) + " chunks of " + std::to_string(chunkBytes) +
                                 " bytes cannot be packed in " + std::to_string(std::min(stored, fileBytes_)),
                             path_);
        return {};
    }

    const Hdf5Session& session_;
    hid_t dataset_;
    std::string name_;
    const std::filesystem::path& path_;
    std::uint64_t fileBytes_;
    Hdf5Handle space_, type_, settings_;
};

/// An attribute of at most kMaxAttributeValues values; `count` is how many.
Hdf5Handle openAttribute(hid_t object, const char* name, hsize_t& count) {
    if (H5Aexists(object, name) <= 0)
        return {};
    Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
    const Hdf5Handle space(attribute.isOpen() ? H5Aget_space(attribute.id()) : -1, H5Sclose);
    const hssize_t values = space.isOpen() ? H5Sget_simple_extent_npoints(space.id()) : 0;
    if (values < 1 || static_cast<hsize_t>(values) > kMaxAttributeValues)
        return {};
    count = static_cast<hsize_t>(values);
    return attribute;
}

std::string untilNull(const char* text, std::size_t most) {
    return std::string(text, std::find(text, text + most, '\0'));
}

} // namespace

Hdf5Session::Hdf5Session() : lock_(oneAtATime()) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); // a setting of the thread; nobody here wants it otherwise
    H5Eclear2(H5E_DEFAULT);
}

Hdf5Session::~Hdf5Session() = default;

Error Hdf5Session::error(std::string_view what, const std::filesystem::path& path) const {
    std::string said;
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keepInnermost, &said);
    said = said.substr(0, said.find('\n'));
    return makeError(ErrorCode::Corruption, std::string(what) + (said.empty() ? "" : ": " + said), path);
}

Result<Hdf5Handle> openHdf5File(const Hdf5Session& session, const std::filesystem::path& path) {
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
#if H5_VERSION_GE(1, 10, 7)
    H5Pset_file_locking(access.id(), false, true); // readers need none, and network folders have none
#endif
    H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
    Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
    if (file.isOpen())
        return file;
    return session.error("is not readable HDF5", path);
}

Hdf5Tree walkHdf5(hid_t file) { return TreeWalk().run(file); }

Status checkStorage(const Hdf5Session& session, hid_t dataset, std::string_view name, const std::filesystem::path& path,
                    std::uint64_t fileBytes) {
    return StorageCheck(session, dataset, name, path, fileBytes).run();
}

Hdf5Handle openDataset(hid_t file, const std::string& name) {
    const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    Hdf5Handle dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Handle settings(dataset.isOpen() ? H5Dget_create_plist(dataset.id()) : -1, H5Pclose);
    if (!settings.isOpen() || H5Pget_layout(settings.id()) != H5D_CHUNKED)
        return dataset;
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const auto extents = extentsOf(space.id());
    std::vector<hsize_t> sizes(extents.size(), 1);
    if (extents.size() < 2 || H5Pget_chunk(settings.id(), static_cast<int>(sizes.size()), sizes.data()) < 0)
        return dataset;
    std::uint64_t chunks = 1, bytes = H5Tget_size(type.id());
    for (std::size_t axis = 0; axis < sizes.size(); ++axis) {
        bytes *= std::max<hsize_t>(sizes[axis], 1);
        if (axis + 2 >= sizes.size())
            chunks *= extents[axis] / std::max<hsize_t>(sizes[axis], 1) + 1;
        if (bytes > kMaxCacheBytes || chunks > kMaxCacheBytes)
            return dataset;
    }
    H5Pset_chunk_cache(access.id(), 10007, std::min(kMaxCacheBytes, chunks * bytes), 1.0);
    dataset.close();
    return Hdf5Handle(H5Dopen2(file, name.c_str(), access.id()), H5Dclose);
}

std::vector<double> attributeNumbers(hid_t object, const char* name) {
    hsize_t count = 0;
    const Hdf5Handle attribute = openAttribute(object, name, count);
    const Hdf5Handle type(attribute.isOpen() ? H5Aget_type(attribute.id()) : -1, H5Tclose);
    if (!type.isOpen() || (H5Tget_class(type.id()) != H5T_FLOAT && H5Tget_class(type.id()) != H5T_INTEGER))
        return {};
    std::vector<double> values(count);
    if (H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, values.data()) < 0)
        return {};
    return values;
}

std::vector<std::string> attributeTexts(hid_t object, const char* name) {
    hsize_t count = 0;
    const Hdf5Handle attribute = openAttribute(object, name, count);
    const Hdf5Handle type(attribute.isOpen() ? H5Aget_type(attribute.id()) : -1, H5Tclose);
    if (!type.isOpen() || H5Tget_class(type.id()) != H5T_STRING)
        return {};
    std::vector<std::string> texts;
    if (H5Tis_variable_str(type.id()) > 0) {
        std::vector<char*> pointers(count, nullptr);
        const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
        if (H5Aread(attribute.id(), type.id(), pointers.data()) < 0)
            return {};
        for (const char* text : pointers)
            texts.emplace_back(text == nullptr ? "" : text);
        H5Dvlen_reclaim(type.id(), space.id(), H5P_DEFAULT, pointers.data());
        return texts;
    }
    const std::size_t size = H5Tget_size(type.id());
    if (size == 0 || size > kMaxHeaderLine)
        return {};
    std::vector<char> bytes(size * count);
    if (H5Aread(attribute.id(), type.id(), bytes.data()) < 0)
        return {};
    for (std::size_t i = 0; i < count; ++i)
        texts.push_back(untilNull(bytes.data() + i * size, size));
    return texts;
}

} // namespace isoslider::io
