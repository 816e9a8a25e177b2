# @MADE@
cmake_minimum_required(VERSION 3.16)
project(@NAME@ VERSION @VERSION@ LANGUAGES C)
include(GNUInstallDirs)

add_library(@NAME@ INTERFACE)
add_library(@NAME@::@NAME@ ALIAS @NAME@)
target_include_directories(@NAME@ INTERFACE
  "$<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>"
  "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
# Square roots, limits, and sines of angles beyond the range of the header's own.
target_link_libraries(@NAME@ INTERFACE "$<$<BOOL:${UNIX}>:m>")
@TESTS@
install(DIRECTORY include/ DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}")
install(TARGETS @NAME@ EXPORT export_@NAME@)
# A project that takes these sources in decides on ament by itself.
if(CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR)
  find_package(ament_cmake QUIET)
endif()
if(ament_cmake_FOUND AND CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR)
  ament_export_targets(export_@NAME@)
  ament_package()
else()
  include(CMakePackageConfigHelpers)
  set(config_folder "${CMAKE_INSTALL_DATADIR}/@NAME@/cmake")
  install(EXPORT export_@NAME@ FILE @NAME@Config.cmake NAMESPACE @NAME@:: DESTINATION "${config_folder}")
  write_basic_package_version_file(@NAME@ConfigVersion.cmake COMPATIBILITY SameMinorVersion ARCH_INDEPENDENT)
  install(FILES "${CMAKE_CURRENT_BINARY_DIR}/@NAME@ConfigVersion.cmake" DESTINATION "${config_folder}")
endif()
