#include "cli/program.hpp"

int main(int argc, char** argv) { return servoctl::cli::run_program({argv + 1, argv + argc}); }
