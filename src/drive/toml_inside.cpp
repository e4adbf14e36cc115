// The parser of toml++, compiled here and nowhere else.
#define TOML_IMPLEMENTATION
#include "drive/toml_reader.hpp"
