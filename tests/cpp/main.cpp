#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>

#include <stdexcept>
#include <string>

#include "echofuse/core/check.hpp"

/// The tests' own fault handler, as a board has one: a broken promise fails the test case that broke it.
void echofuse::check_failed(const char* expression, const char* file, int line) {
  throw std::logic_error(std::string(file) + ":" + std::to_string(line) + ": " + expression);
}
