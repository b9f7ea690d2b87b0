# Toolchain file of the bare-metal presets: Debian's gcc-arm-none-eabi with newlib. ECHOFUSE_CPU and ECHOFUSE_FPU come
# from the preset, and of an installed echofuse from two lines above this one. No -fpic, no unwind tables, and a section for every function, so that the linker drops what an image does
# not call. The whole newlib and not its nano variant, whose memcpy moves one byte at a time.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES ECHOFUSE_CPU ECHOFUSE_FPU)

string(JOIN " " CMAKE_CXX_FLAGS_INIT
  -mcpu=${ECHOFUSE_CPU} -mthumb -mfpu=${ECHOFUSE_FPU} -mfloat-abi=hard
  -ffunction-sections -fdata-sections -fno-threadsafe-statics -fno-use-cxa-atexit
  -fno-unwind-tables -fno-asynchronous-unwind-tables -fstack-usage)
