
# Tests are for whoever builds the package by itself, not for a project that takes it in.
if(CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR)
  include(CTest)
  if(BUILD_TESTING)
    foreach(test TESTS)
      add_executable(${test} test/${test}.c)
      target_include_directories(${test} PRIVATE "${CMAKE_CURRENT_SOURCE_DIR}/include/@NAME@")
      target_link_libraries(${test} PRIVATE @NAME@)
      add_test(NAME ${test} COMMAND ${test})
    endforeach()
  endif()
endif()
