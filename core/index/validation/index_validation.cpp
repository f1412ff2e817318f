#include "core/index/validation/index_validation.h"

#include <atomic>
#include <limits>
#include <locale>
#include <memory>
#include <sstream>
#include <string>

#include "core/index/index_appendix.h"
#include "core/index/validation/fault_list.h"
#include "core/index/validation/level_checks.h"
#include "core/index/validation/part_checks.h"
#include "core/index/validation/sample_survey.h"

namespace isoslider::index {
namespace {

std::string dimsText(const GridDims& dims) {
    return std::to_string(dims[0]) + " x " + std::to_string(dims[1]) + " x " + std::to_string(dims[2]);
}

std::string vectorText(const glm::dvec3& vector) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text.precision(std::numeric_limits<double>::max_digits10);
    text << vector.x << ' ' << vector.y << ' ' << vector.z;
    return text.str();
}

/// REQUIRES: the two differ.
std::string placeDifference(const GridGeometry& index, const GridGeometry& volume) {
    if (index.spacing != volume.spacing)
        return "spacing " + vectorText(index.spacing) + ", not " + vectorText(volume.spacing);
    if (index.origin != volume.origin)
        return "origin " + vectorText(index.origin) + ", not " + vectorText(volume.origin);
    return "other directions of the axes";
}

class Validation {
public:
    Validation(const IndexReader& reader, const ValidationOptions& options, FaultList& faults, ValidationReport& report)
        : reader_(reader), options_(options), faults_(faults), report_(report) {}

    Status run(const std::filesystem::path& path, FileSystem& fileSystem, const JobControl& job) {
        const bool readsMore = options_.isFull || options_.volume;
        findAppendixFault(path, fileSystem);
        checkFacts();
        ISO_TRY(checkParts(reader_, options_.isFull, faults_, report_, job.part(0.0, readsMore ? 0.2 : 1.0)));
        if (options_.volume && !isOfTheVolume())
            return {}; // comparing more would name the same again
        const bool isEdges = reader_.info().kind == IndexKind::Edges;
        Level0Sums sums(reader_.grid().brickCount());
        if (isEdges && reader_.info().mergeError > 0.0 &&
            PointKeySums::wordCount(reader_.grid().brickCount()) <= options_.memoryBytes / sizeof(std::uint64_t) / 2)
            sums.pointKeys = std::make_unique<PointKeySums>(reader_.grid().brickCount());
        bool comparesList = options_.volume && isEdges && !options_.isFull; // with the volume
        if (options_.isFull || comparesList)
            ISO_TRY(checkLevels(reader_, faults_, sums, job.part(0.2, 0.6)));
        const SurveyOptions ofSamples{options_.memoryBytes, "the samples"};
        if (options_.isFull) {
            const auto areWhole = checkStoredSamples(sums, ofSamples, job.part(0.6, options_.volume ? 0.8 : 1.0));
            if (!areWhole.isOk())
                return areWhole.error();
            comparesList = options_.volume && !areWhole.value();
        }
        if (options_.volume)
            ISO_TRY(compareWithVolume(comparesList ? &sums : nullptr, job));
        return {};
    }

private:
    // `list`: what the index states of edges, where that is compared too.
    Status compareWithVolume(const Level0Sums* list, const JobControl& job) {
        const std::uint64_t before = faults_.count();
        if (list != nullptr)
            ISO_TRY(surveySamples(reader_, *options_.volume, list, faults_, {options_.memoryBytes, "the volume"},
                                  job.part(0.6, 0.8)));
        ISO_TRY(compareSamples(reader_, *options_.volume, faults_, job.part(0.8, 1.0)));
        report_.differences += faults_.count() - before;
        report_.areSamplesCompared = true;
        return {};
    }

    void refuse(const char* part, std::string problem) {
        IndexFault fault;
        fault.part = part;
        fault.problem = std::move(problem);
        faults_.add(std::move(fault));
    }

    // One that is not finished is read as none. Whether writing it was cut off or zeros took the place of its header
    // cannot be distinguished, so it is reported.
    void findAppendixFault(const std::filesystem::path& path, FileSystem& fileSystem) {
        const auto check = checkAppendix(path, fileSystem);
        if (!check.isOk())
            return;
        IndexFault fault;
        fault.part = "appendix";
        fault.offset = check.value().end;
        switch (check.value().state) {
            case AppendixState::None:
            case AppendixState::Whole: return;
            case AppendixState::Unfinished: fault.problem = "is not finished, or has lost its header"; break;
            case AppendixState::Followed: fault.problem = "is followed by bytes that belong to nothing"; break;
            case AppendixState::Damaged: fault.problem = "fails its checksum, or belongs to another index"; break;
        }
        faults_.add(std::move(fault));
    }

    // What meta states twice, or must add up to.
    void checkFacts() {
        const IndexInfo& info = reader_.info();
        std::uint64_t finite = 0;
        for (const std::uint64_t count : info.histogram.counts)
            finite += count;
        const auto points = static_cast<std::uint64_t>(pointCount(info.geometry.dims));
        if (info.nanCount > points || finite != points - info.nanCount)
            refuse("histogram", "does not count all finite samples");
        if (info.histogram.min != info.min || info.histogram.max != info.max)
            refuse("histogram", "has another range than the samples");
        if (info.distinctValues > finite || info.distinctValues == 0)
            refuse("number of distinct values", "is not possible");
        std::uint64_t chunkBytes = 0;
        for (const ChunkGroupEntry& group : reader_.meta().chunkGroups)
            chunkBytes += group.chunkBytes;
        if (chunkBytes != info.chunkBytes)
            refuse("bytes of chunks", "are not those of the chunk groups");
    }

    bool isOfTheVolume() {
        const std::uint64_t before = faults_.count();
        const ComparedVolume& volume = *options_.volume;
        const IndexInfo& info = reader_.info();
        if (volume.geometry.dims != info.geometry.dims)
            refuse("grid",
                   "has " + dimsText(info.geometry.dims) + " points, the volume " + dimsText(volume.geometry.dims));
        else if (volume.type != info.type)
            refuse("scalar type", "is " + std::string(scalarTypeName(info.type)) + ", that of the volume " +
                                      std::string(scalarTypeName(volume.type)));
        else if (!(volume.geometry == info.geometry))
            refuse("grid", "lies elsewhere in space than that of the volume: " +
                               placeDifference(info.geometry, volume.geometry));
        report_.differences += faults_.count() - before;
        return volume.geometry.dims == info.geometry.dims && volume.type == info.type;
    }

    // Whether all chunks could be read.
    Result<bool> checkStoredSamples(const Level0Sums& sums, const SurveyOptions& options, const JobControl& job) {
        const SampleStore store(reader_);
        std::atomic<bool> hasFailed = false;
        const ComparedVolume planes = storedPlanes(reader_, store, hasFailed);
        // With samples missing nothing would agree: what is wrong has been said.
        FaultList found(reader_, options_.mostFaults);
        ISO_TRY(surveySamples(reader_, planes, &sums, found, options, job));
        if (hasFailed)
            return false;
        for (IndexFault& fault : found.take())
            faults_.add(std::move(fault));
        return true;
    }

    const IndexReader& reader_;
    const ValidationOptions& options_;
    FaultList& faults_;
    ValidationReport& report_;
};

} // namespace

Result<ValidationReport> validateIndex(const std::filesystem::path& path, const ValidationOptions& options,
                                       const JobControl& job, FileSystem& fileSystem) {
    const auto reader = IndexReader::open(path, fileSystem);
    if (!reader.isOk())
        return reader.error();
    ValidationReport report;
    report.info = reader.value()->info();
    FaultList faults(*reader.value(), options.mostFaults);
    ISO_TRY(Validation(*reader.value(), options, faults, report).run(path, fileSystem, job));
    report.bytes += report.info.indexBytes - reader.value()->metaOffset() + kPreambleBytes;
    report.faultCount = faults.count();
    report.faults = faults.take();
    return report;
}

} // namespace isoslider::index
