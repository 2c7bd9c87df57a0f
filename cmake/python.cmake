# The Python module (docs/python.md), for the interpreter that CMake finds; SUPPLE_PYTHON wants it.
set(supple_python_missing "")
find_package(Python3 COMPONENTS Interpreter Development.Module QUIET)
find_package(pybind11 QUIET CONFIG)
if(NOT Python3_Development.Module_FOUND)
  set(supple_python_missing "Python's headers (python3-dev)")
elseif(NOT pybind11_FOUND)
  set(supple_python_missing "pybind11 (pybind11-dev)")
endif()
if(supple_python_missing)
  message(STATUS "The Python module is left out, for want of ${supple_python_missing}")
  return()
endif()

file(GLOB supple_python_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/python/src/*.cpp)
pybind11_add_module(supple_python MODULE NO_EXTRAS ${supple_python_sources})
target_link_libraries(supple_python PRIVATE supple_app)
# Headers of pybind11 and of Python are not ours to warn about. Symbols of the libraries stay inside the module.
target_link_options(supple_python PRIVATE -Wl,--exclude-libs,ALL)
set_target_properties(supple_python PROPERTIES OUTPUT_NAME _supple UNITY_BUILD OFF
                      LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/python/supple)
# The build's folder has the package whole, so that PYTHONPATH=build/release/python finds it.
file(GLOB supple_python_files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/python/supple/*.py
     ${PROJECT_SOURCE_DIR}/python/supple/*.pyi ${PROJECT_SOURCE_DIR}/python/supple/py.typed)
add_custom_command(TARGET supple_python POST_BUILD
                   COMMAND ${CMAKE_COMMAND} -E copy_if_different ${supple_python_files}
                           ${PROJECT_BINARY_DIR}/python/supple)
install(TARGETS supple_python DESTINATION ${SUPPLE_PYTHON_FOLDER}/supple COMPONENT python)
install(FILES ${supple_python_files} DESTINATION ${SUPPLE_PYTHON_FOLDER}/supple COMPONENT python)
