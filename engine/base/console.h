// Words for the terminal. A closed or full standard stream must not end a run: what cannot be said is left unsaid.
#pragma once

#include <cstdio>
#include <string_view>

namespace supple {

inline void say(std::FILE* stream, std::string_view text) { (void)!std::fwrite(text.data(), 1, text.size(), stream); }

}  // namespace supple
