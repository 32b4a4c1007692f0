# Named in colcon.meta as CMAKE_PROJECT_wsn_tracking_msgs_INCLUDE, so that CMake reads it at project().
#
# The ROS 2 wheels export include folders of the machine that built them, and CMake refuses an imported target
# whose include folder does not exist. When the package's CMakeLists.txt has been read (all targets are known,
# nothing is generated yet), every imported target keeps the folders that exist and the generator expressions.
# With an installed ROS all folders exist, and this changes nothing.

function(wsn_drop_missing_include_dirs)
  get_property(targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(dirs ${target} INTERFACE_INCLUDE_DIRECTORIES)
    if(NOT dirs)
      continue()
    endif()
    set(kept)
    foreach(dir IN LISTS dirs)
      if(dir MATCHES "^\\$<" OR EXISTS "${dir}")
        list(APPEND kept "${dir}")
      endif()
    endforeach()
    set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${kept}")
  endforeach()
endfunction()

cmake_language(DEFER CALL wsn_drop_missing_include_dirs)
