#pragma once

#include <memory>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/outcome.h"
#include "app/cli/output.h"

namespace CLI {
class App;
}

namespace isoslider::cli {

/// What every command is given.
struct Session {
    std::stop_token stop; ///< requested by SIGINT, SIGTERM and SIGHUP
    bool isJson = false; ///< one object on standard output and nothing else
    bool isQuiet = false; ///< nothing but failures, and --json where it is asked for
    bool showsProgress = false; ///< standard error is a terminal, and nobody asked for JSON or silence
    Output output;
    /// Names of files that nobody has given, and what is said in place of them, in failures too.
    std::vector<std::pair<std::string, std::string>> shownNames;

    /// `text` with all of them replaced, the first ones first. REQUIRES: none is empty.
    std::string shown(std::string text) const;
};

/// One word of the command line: declares its options, then runs with what was given.
/// REQUIRES: the command outlives the parser that it declared its options to.
class Command {
public:
    virtual ~Command() = default;
    /// Adds its subcommand. Options whose text is no number or name throw CLI::ParseError on parsing.
    virtual CLI::App* declare(CLI::App& program) = 0;
    /// Writes to the session's output only when it succeeds or has found a fault.
    virtual Outcome run(Session& session) = 0;
};

std::unique_ptr<Command> makeInfoCommand();
std::unique_ptr<Command> makeBuildCommand();
std::unique_ptr<Command> makeStatsCommand();
std::unique_ptr<Command> makeExtractCommand();
std::unique_ptr<Command> makeSlideCommand();
std::unique_ptr<Command> makeCheckCommand();
std::unique_ptr<Command> makeResampleCommand();
std::unique_ptr<Command> makeReportCommand();
std::unique_ptr<Command> makeTopologyCommand();
std::unique_ptr<Command> makeValidateCommand();

} // namespace isoslider::cli
