#include "ui/model/surface/surface_source.h"

#include <chrono>

#include "core/extract/full_extraction.h"

namespace isoslider::model {
namespace {

class FullExtractionSource final : public SurfaceSource {
public:
    explicit FullExtractionSource(std::shared_ptr<const ScalarGrid> grid) : grid_(std::move(grid)) {}

    Status moveTo(double isovalue, const JobControl& job, extract::SurfaceFrame& frame) override {
        const auto begin = std::chrono::steady_clock::now();
        auto surface = extract::extractFull(*grid_, isovalue, job);
        if (!surface.isOk())
            return surface.error();
        isovalue_ = isovalue;
        auto& mesh = surface.value();
        frame.stats = {};
        frame.stats.isovalue = isovalue;
        frame.stats.activeEdges = mesh.activeEdgeCount();
        frame.stats.triangles = mesh.triangleCount();
        frame.stats.cellsRetriangulated = 0;
        frame.stats.hasRebuilt = true;
        frame.bricks.reset();
        frame.pieces.reset();
        frame.geometry = grid_->geometry();
        frame.isovalue = isovalue;
        frame.mergeBound = {};
        frame.region.reset();
        frame.isFromIndex = false;
        frame.isWholeExtraction = true;
        frame.positions = std::move(mesh.positions);
        frame.normals = std::move(mesh.normals);
        frame.indices = std::move(mesh.triangles);
        frame.changedIndices.clear();
        frame.stats.updateMs =
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
        return {};
    }

    Result<extract::SurfaceMesh> mesh(const JobControl& job) override {
        return extract::extractFull(*grid_, isovalue_, job);
    }

private:
    std::shared_ptr<const ScalarGrid> grid_;
    double isovalue_ = 0.0;
};

class EngineSource final : public SurfaceSource {
public:
    explicit EngineSource(std::unique_ptr<extract::SlideEngine> engine) : engine_(std::move(engine)) {}

    Status moveTo(double isovalue, const JobControl& job, extract::SurfaceFrame& frame) override {
        engine_->setMergeBound(frame.mergeBound);
        engine_->setRegion(frame.findsPieces ? std::nullopt : frame.region);
        isWhole_ = false;
        auto stats = engine_->slideTo(isovalue, job);
        if (!stats.isOk())
            return stats.error();
        const bool isSameGrid = frame.geometry == engine_->info().geometry;
        engine_->copyFrame(frame, {.changes = frame.marksChanges,
                                   .pieces = frame.findsPieces,
                                   .piecesBefore = isSameGrid ? frame.pieces : nullptr});
        frame.mergeBound = engine_->mergeBound();
        frame.region = engine_->region();
        isovalue_ = isovalue;
        isWhole_ = !frame.region;
        frame.stats = std::move(stats).value();
        frame.geometry = engine_->info().geometry;
        frame.isovalue = isovalue;
        frame.isWholeExtraction = false;
        return {};
    }

    Result<extract::SurfaceMesh> mesh(const JobControl& job) override {
        if (!isWhole_) {
            engine_->setRegion(std::nullopt);
            if (auto moved = engine_->slideTo(isovalue_, job); !moved.isOk())
                return std::move(moved).error();
            isWhole_ = true;
        }
        return engine_->mesh(job);
    }

private:
    std::unique_ptr<extract::SlideEngine> engine_;
    double isovalue_ = 0.0; ///< of the last move that succeeded
    bool isWhole_ = false; ///< the engine has the whole surface there
};

class MemorySource final : public SurfaceSource {
public:
    MemorySource(std::shared_ptr<const ScalarGrid> grid, std::shared_ptr<IndexBuilder> builder)
        : grid_(std::move(grid)), builder_(std::move(builder)) {}

    Status moveTo(double isovalue, const JobControl& job, extract::SurfaceFrame& frame) override {
        if (source_)
            return source_->moveTo(isovalue, job, frame);
        ISO_TRY(makeSource(job.part(0.0, kShareOfSource)));
        return source_->moveTo(isovalue, job.part(kShareOfSource, 1.0), frame);
    }

    Result<extract::SurfaceMesh> mesh(const JobControl& job) override {
        if (!source_)
            ISO_TRY(makeSource(job));
        return source_->mesh(job);
    }

private:
    static constexpr double kShareOfSource = 0.3; // of the first move's time, about

    Status makeSource(const JobControl& job) {
        auto engine = builder_->engineInMemory(grid_, job);
        if (!engine.isOk())
            return std::move(engine).error();
        source_ = engine.value() ? makeIndexSource(std::move(engine).value()) : makeFullExtractionSource(grid_);
        return {};
    }

    std::shared_ptr<const ScalarGrid> grid_;
    std::shared_ptr<IndexBuilder> builder_;
    std::unique_ptr<SurfaceSource> source_;
};

} // namespace

std::unique_ptr<SurfaceSource> makeMemorySource(std::shared_ptr<const ScalarGrid> grid,
                                                std::shared_ptr<IndexBuilder> builder) {
    if (!builder)
        return makeFullExtractionSource(std::move(grid));
    return std::make_unique<MemorySource>(std::move(grid), std::move(builder));
}

std::unique_ptr<SurfaceSource> makeFullExtractionSource(std::shared_ptr<const ScalarGrid> grid) {
    return std::make_unique<FullExtractionSource>(std::move(grid));
}

std::unique_ptr<SurfaceSource> makeIndexSource(std::unique_ptr<extract::SlideEngine> engine) {
    return std::make_unique<EngineSource>(std::move(engine));
}

SourceOpener openerOfIndex(std::filesystem::path index) {
    return [index = std::move(index)](const JobControl&) -> Result<std::unique_ptr<SurfaceSource>> {
        extract::SlideOptions options; // it moves once
        options.cacheBytes = extract::kSmallCacheBytes;
        options.readsAhead = options.buildsLevels = false;
        auto engine = extract::SlideEngine::open(index, options);
        if (!engine.isOk())
            return std::move(engine).error();
        return makeIndexSource(std::move(engine).value());
    };
}

SourceOpener openerOfMemory(std::shared_ptr<const ScalarGrid> grid, std::shared_ptr<IndexBuilder> builder) {
    return [grid = std::move(grid), builder = std::move(builder)](
               const JobControl&) -> Result<std::unique_ptr<SurfaceSource>> { return makeMemorySource(grid, builder); };
}

} // namespace isoslider::model
