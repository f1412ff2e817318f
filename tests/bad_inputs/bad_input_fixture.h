#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tests/cli/cli_fixture.h"

namespace isoslider::test {

/// Inputs that users, disks and forgers come up with, given to the real program. Each test is named by the
/// number of its case in the catalogue, B001 to B113.
class BadInputTest : public CliTest {
protected:
    /// Refused input: exit 3, nothing on standard output, one line that states `saying`; at most a second of
    /// processor time, and 64 MiB more than the program takes for a small good file.
    void expectRefusedSoon(const std::vector<std::string>& arguments, std::string_view saying, int exitCode = 3) const;
    /// As above, of `info FILE`.
    void expectFileRefused(const std::string& name, const std::string& bytes, std::string_view saying) const;
    /// Exit 0, nothing on standard error, within the same bounds of time and memory.
    OrderedJson expectAcceptedSoon(std::vector<std::string> arguments) const;

    /// Writes bytes as NAME and gives the words that describe them as raw samples.
    std::vector<std::string> raw(const std::string& name, const std::string& bytes, const std::string& dims,
                                 const std::string& type) const;

private:
    void expectSmall(const ProcessResult& result) const;
};

/// Samples as they lie in memory.
template <class Sample>
std::string samplesOf(const std::vector<Sample>& samples) {
    return {reinterpret_cast<const char*>(samples.data()), samples.size() * sizeof(Sample)};
}

/// What comes before, and then.
std::vector<std::string> joined(std::vector<std::string> words, const std::vector<std::string>& more);

} // namespace isoslider::test
