#pragma once

/// The only place that includes Eigen's core. Its assertions become our debug checks: Eigen's own would bring
/// stdio, and with it malloc, into a firmware image. Its other macros are PUBLIC definitions of
/// echofuse::core. Include Eigen's further modules (<Eigen/Cholesky>, ...) after this header.

#if defined(EIGEN_CORE_H) || defined(EIGEN_CORE_MODULE_H)
#error "include echofuse/core/eigen.hpp before any header of Eigen"
#endif

#include "echofuse/core/check.hpp"

#define eigen_assert(condition) ECHOFUSE_DEBUG_CHECK(condition)

#include <Eigen/Core>
