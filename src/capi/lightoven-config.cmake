# lightoven::lightoven, the shared library, and lightoven::static. lightoven.h includes Vulkan's headers, which the engine has.
get_filename_component(_lightoven_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
include(CMakeFindDependencyMacro)
find_dependency(Threads)

if(NOT TARGET lightoven::lightoven)
    add_library(lightoven::lightoven SHARED IMPORTED)
    set_target_properties(lightoven::lightoven PROPERTIES
        IMPORTED_LOCATION "${_lightoven_prefix}/lib/liblightoven.so"
        IMPORTED_SONAME "liblightoven.so.0.1"
        INTERFACE_INCLUDE_DIRECTORIES "${_lightoven_prefix}/include")

    add_library(lightoven::static STATIC IMPORTED)
    set_target_properties(lightoven::static PROPERTIES
        IMPORTED_LOCATION "${_lightoven_prefix}/lib/liblightoven.a"
        INTERFACE_INCLUDE_DIRECTORIES "${_lightoven_prefix}/include"
        INTERFACE_LINK_LIBRARIES "Threads::Threads;m;${CMAKE_DL_LIBS};util;rt;gcc_s")
endif()

unset(_lightoven_prefix)
