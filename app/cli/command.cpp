#include "app/cli/command.h"

namespace isoslider::cli {

std::string Session::shown(std::string text) const {
    for (const auto& [name, words] : shownNames)
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + words.size()))
            text.replace(at, name.size(), words);
    return text;
}

} // namespace isoslider::cli
