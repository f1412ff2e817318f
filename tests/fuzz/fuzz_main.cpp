#include <cstdint>

#include "tests/fuzz/fuzz_targets.h"

// One program for each target: ISO_FUZZ_TARGET is its function. Names and types are libFuzzer's.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    isoslider::fuzz::ISO_FUZZ_TARGET(std::as_bytes(std::span(data, size)));
    return 0;
}
