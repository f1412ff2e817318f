#include <array>
#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "app/cli/command.h"
#include "app/cli/interrupt_watch.h"

namespace isoslider::cli {
namespace {

/// A message of several lines, from a library, becomes one.
void printFailure(std::string line) {
    for (char& c : line)
        c = c == '\n' || c == '\r' ? ' ' : c;
    std::fputs(("isoslider-cli: " + line + "\n").c_str(), stderr); // fmt throws where that is closed
}

struct Entry {
    std::unique_ptr<Command> command;
    CLI::App* parser = nullptr;
};

class Program {
public:
    Program() : parser_("Slides isosurfaces through large volumes.", "isoslider-cli") {
        parser_.require_subcommand(1);
        parser_.set_version_flag("--version", std::string("isoslider-cli ") + ISOSLIDER_VERSION);
        parser_.option_defaults()->always_capture_default(false);
        for (const auto make :
             {makeInfoCommand, makeBuildCommand, makeStatsCommand, makeExtractCommand, makeSlideCommand,
              makeCheckCommand, makeResampleCommand, makeReportCommand, makeTopologyCommand, makeValidateCommand})
            add(make());
    }

    Outcome run(int argc, char** argv) {
        try {
            parser_.parse(argc, argv);
        } catch (const CLI::Success& request) {
            std::ostringstream text, none;
            parser_.exit(request, text, none); // --help or --version
            session_.output.write(text.str());
            return finish({});
        } catch (const CLI::RequiredError& error) {
            // What is missing may well be what was mistyped: first the command, on which options depend.
            const bool isCommandMissing = parser_.get_subcommands().empty();
            if (isCommandMissing && argc > 1 && argv[1][0] != '-')
                return Outcome::wrongUsage(fmt::format("'{}' is not a command; see --help", argv[1]));
            if (const std::string unknown = unknownOption(); !unknown.empty())
                return Outcome::wrongUsage(fmt::format("'{}' is not an option; see --help", unknown));
            return Outcome::wrongUsage(isCommandMissing ? "a command is required; see --help" : error.what());
        } catch (const CLI::ExtrasError& error) {
            const std::string unknown = unknownOption();
            return Outcome::wrongUsage(unknown.empty() ? error.what()
                                                       : fmt::format("'{}' is not an option; see --help", unknown));
        } catch (const CLI::ParseError& error) {
            return Outcome::wrongUsage(error.what());
        }
        const InterruptWatch interrupts;
        session_.stop = interrupts.stop();
        session_.showsProgress = !session_.isJson && !session_.isQuiet && ::isatty(STDERR_FILENO) == 1;
        session_.output.setSilent(session_.isQuiet && !session_.isJson);
        for (const auto& entry : entries_) {
            if (entry.parser->parsed())
                return finish(entry.command->run(session_));
        }
        return Outcome::wrongUsage("a command is required; see --help");
    }

private:
    void add(std::unique_ptr<Command> command) {
        auto* parser = command->declare(parser_);
        parser->add_flag("--json", session_.isJson, "one JSON object on standard output and nothing else");
        parser->add_flag("-q,--quiet", session_.isQuiet, "no progress, no report: failures only");
        entries_.push_back({std::move(command), parser});
    }

    /// The first word that looks like an option and is none; empty if there is none such.
    std::string unknownOption() const {
        for (const std::string& word : parser_.remaining(true))
            if (word.size() > 1 && word[0] == '-' && word != "--")
                return word.substr(0, word.find('='));
        return {};
    }

    Outcome finish(const Outcome& outcome) {
        const auto written = session_.output.flush();
        if (outcome.isSuccess())
            return written.isOk() ? outcome : Outcome(written.error());
        return {outcome.code(), session_.shown(outcome.line())};
    }

    CLI::App parser_;
    Session session_;
    std::vector<Entry> entries_;
};

// A file that is opened later must not take the place of a stream that the shell has closed, and get what is said
// there. Each is opened the wrong way: to use it is an error, as before.
void occupyStandardStreams() {
    for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor)
        if (::fcntl(descriptor, F_GETFD) < 0)
            static_cast<void>(::open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

int runProgram(int argc, char** argv) {
    occupyStandardStreams();
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN); // a file beyond the shell's limit is a failed write like any other
    try {
        const Outcome outcome = Program().run(argc, argv);
        if (!outcome.isSuccess())
            printFailure(outcome.line());
        return static_cast<int>(outcome.code());
    } catch (const std::bad_alloc&) {
        printFailure("out of memory");
    } catch (const std::exception& error) {
        printFailure(error.what());
    }
    return static_cast<int>(ExitCode::IoFailure);
}

} // namespace
} // namespace isoslider::cli

int main(int argc, char** argv) { return isoslider::cli::runProgram(argc, argv); }
