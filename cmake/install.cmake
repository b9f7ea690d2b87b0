# `cmake --install`: headers, libraries, and what find_package(echofuse) reads. The generated messages stay behind: no
# public header includes them.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/echofuse)

# What the libraries' code and calls are made for must be said again to whoever links them: a hard-float library and a
# soft-float program do not link, and code for a Cortex-M7's double precision faults on an M4.
set(echofuse_machine_flags "")
if(CMAKE_CROSSCOMPILING)
  string(REGEX MATCHALL "-m(cpu|arch|thumb|fpu|float-abi)[^ ]*" echofuse_machine_flags "${CMAKE_CXX_FLAGS}")
endif()
foreach(flag IN LISTS echofuse_machine_flags)
  target_compile_options(echofuse_core PUBLIC $<INSTALL_INTERFACE:${flag}>)
  target_link_options(echofuse_core PUBLIC $<INSTALL_INTERFACE:${flag}>)
endforeach()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/cpp/include/echofuse TYPE INCLUDE FILES_MATCHING PATTERN *.hpp)
if(ECHOFUSE_LIMITS_HEADER)
  install(FILES "${limits_header}" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/echofuse/core RENAME port_limits.hpp)
endif()
install(TARGETS echofuse_core echofuse_signal echofuse_estimation echofuse_link echofuse_node echofuse_hub
        EXPORT echofuse INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT echofuse NAMESPACE echofuse:: FILE echofuseTargets.cmake DESTINATION ${package_folder})

configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/echofuseConfig.cmake.in
  ${PROJECT_BINARY_DIR}/echofuseConfig.cmake INSTALL_DESTINATION ${package_folder}
  NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# It also refuses a consumer whose pointers have another size: a host's library is not found for a bare machine.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/echofuseConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/echofuseConfig.cmake ${PROJECT_BINARY_DIR}/echofuseConfigVersion.cmake
        ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${package_folder})

# The toolchain file, with the processor that the libraries were built for.
if(CMAKE_TOOLCHAIN_FILE MATCHES "/arm_none_eabi.cmake$")
  file(READ ${PROJECT_SOURCE_DIR}/firmware_sim/arm_none_eabi.cmake toolchain)
  file(CONFIGURE OUTPUT arm_none_eabi.cmake @ONLY CONTENT
       "set(ECHOFUSE_CPU @ECHOFUSE_CPU@)\nset(ECHOFUSE_FPU @ECHOFUSE_FPU@)\n@toolchain@")
  install(FILES ${PROJECT_BINARY_DIR}/arm_none_eabi.cmake DESTINATION ${package_folder})
endif()
