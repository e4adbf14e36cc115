#include "cli/program.hpp"

#ifdef SERVOCTL_STATIC
#include <nss.h>
#endif

int main(int argc, char** argv) {
#ifdef SERVOCTL_STATIC
  // Other ways to find a host or a user are libraries, which fit the C library of their own system alone.
  ::__nss_configure_lookup("hosts", "files dns");
  ::__nss_configure_lookup("passwd", "files");
  ::__nss_configure_lookup("group", "files");
#endif
  return servoctl::cli::run_program({argv + 1, argv + argc});
}
