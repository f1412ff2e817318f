#include "tests/bench/probes.h"

#include <cstdio>

#include <fmt/format.h>

namespace isoslider::bench {
namespace {

std::string quoted(const std::filesystem::path& path) {
    std::string out = "'";
    for (const char c : path.string())
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

// What a program beside this one prints.
Result<std::string> outputOf(const std::string& name, const std::string& arguments) {
    const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
    std::FILE* pipe = ::popen((quoted(program) + " " + arguments).c_str(), "r");
    if (pipe == nullptr)
        return makeError(ErrorCode::IoError, "cannot start", program.string());
    std::string output;
    char buffer[256];
    while (std::fgets(buffer, sizeof buffer, pipe) != nullptr)
        output += buffer;
    if (::pclose(pipe) != 0)
        return makeError(ErrorCode::IoError, "failed", program.string());
    return output;
}

std::string argumentsFor(const VolumeFile& volume) {
    return fmt::format("{} {} {} {} {}", quoted(volume.path), volume.dims[0], volume.dims[1], volume.dims[2],
                       scalarTypeName(volume.type));
}

double perEdge(std::uint64_t bytes, std::uint64_t emptyBytes, std::uint64_t edges) {
    return bytes > emptyBytes && edges > 0 ? static_cast<double>(bytes - emptyBytes) / static_cast<double>(edges) : 0.0;
}

} // namespace

double ProbeResult::bytesPerEdgeAtFirst() const { return perEdge(firstBytes, emptyBytes, firstEdges); }
double ProbeResult::bytesPerEdgeAfterSlide() const { return perEdge(slideBytes, emptyBytes, mostEdges); }

Result<ProbeResult> probeSlide(const ProbeRequest& request) {
    std::string arguments = request.volume ? "--memory " + argumentsFor(*request.volume) : quoted(request.index);
    arguments +=
        fmt::format(" {} {}", request.threads, request.cacheBytes ? static_cast<long long>(*request.cacheBytes) : -1LL);
    for (const double isovalue : request.isovalues)
        arguments += fmt::format(" {}", isovalue);
    const auto output = outputOf("slide_probe", arguments);
    if (!output.isOk())
        return output.error();
    ProbeResult result;
    unsigned long long bytes[4] = {}, edges[2] = {};
    const int fields =
        std::sscanf(output.value().c_str(), "%lf %lf %llu %llu %llu %llu %llu %llu", &result.openMs,
                    &result.firstSurfaceMs, &bytes[0], &bytes[1], &bytes[2], &bytes[3], &edges[0], &edges[1]);
    if (fields != 8)
        return makeError(ErrorCode::IoError, "did not answer", "slide_probe");
    result.emptyBytes = bytes[0];
    result.firstBytes = bytes[1];
    result.slideBytes = bytes[2];
    result.peakBytes = bytes[3];
    result.firstEdges = edges[0];
    result.mostEdges = edges[1];
    return result;
}

Result<BuildProbeResult> probeBuild(const BuildProbeRequest& request) {
    const auto output =
        outputOf("build_probe", fmt::format("{} {} {} {} {}", argumentsFor(request.volume), quoted(request.index),
                                            index::indexKindName(request.kind), request.threads, request.memoryBytes));
    if (!output.isOk())
        return output.error();
    BuildProbeResult result;
    unsigned long long bytes[2] = {};
    if (std::sscanf(output.value().c_str(), "%lf %llu %llu", &result.seconds, &bytes[0], &bytes[1]) != 3)
        return makeError(ErrorCode::IoError, "did not answer", "build_probe");
    result.emptyBytes = bytes[0];
    result.peakBytes = bytes[1];
    return result;
}

Result<TopologyProbeResult> probeTopology(const std::filesystem::path& index, int threads) {
    const auto output = outputOf("topology_cost_probe", fmt::format("{} {}", quoted(index), threads));
    if (!output.isOk())
        return output.error();
    TopologyProbeResult result;
    unsigned long long bytes[2] = {}, events = 0;
    if (std::sscanf(output.value().c_str(), "%lf %lf %llu %llu %llu", &result.seconds, &result.processorSeconds,
                    &bytes[0], &bytes[1], &events) != 5)
        return makeError(ErrorCode::IoError, "did not answer", "topology_cost_probe");
    result.emptyBytes = bytes[0];
    result.peakBytes = bytes[1];
    result.events = events;
    return result;
}

} // namespace isoslider::bench
