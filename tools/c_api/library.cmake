# What all libraries have in common: one set of flags, and only what their public headers declare is visible.

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
set(THREADS_PREFER_PTHREAD_FLAG ON)
find_package(Threads REQUIRED)

set(TILENCA_C_API_DIR ${CMAKE_CURRENT_LIST_DIR})
set(TILENCA_FIRMWARE_DIR ${PROJECT_SOURCE_DIR}/firmware)

add_library(tilenca_flags INTERFACE)
target_compile_options(tilenca_flags INTERFACE
    -Wall -Wextra -Wshadow -Wpedantic -Wundef -Wcast-align -Wcast-qual -Wnon-virtual-dtor -Woverloaded-virtual
    -Wold-style-cast -Wno-psabi # no vector crosses the border of a library
    $<$<BOOL:${TILENCA_WERROR}>:-Werror>)
target_include_directories(tilenca_flags INTERFACE
    ${PROJECT_SOURCE_DIR}/tools ${TILENCA_C_API_DIR}/include ${TILENCA_FIRMWARE_DIR}/include)
target_link_libraries(tilenca_flags INTERFACE Threads::Threads)
if(TILENCA_SANITIZE)
    target_compile_options(tilenca_flags INTERFACE
        -fsanitize=${TILENCA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(tilenca_flags INTERFACE -fsanitize=${TILENCA_SANITIZE})
endif()

if(TILENCA_LTO AND NOT TILENCA_BUILT)
    include(CheckIPOSupported)
    check_ipo_supported(RESULT TILENCA_CAN_LTO OUTPUT why_not LANGUAGES CXX)
    if(NOT TILENCA_CAN_LTO)
        message(STATUS "no optimisation when linking: ${why_not}")
    endif()
endif()

# tilenca_library(NAME OBJECTS TARGET... [LTO]): the shared library libNAME.so of object libraries, whose public
# header is include/tilenca/*.h of the present folder. For WebAssembly only the objects: web/ makes modules of them.
function(tilenca_library name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "LTO" "" "OBJECTS")
    foreach(objects IN LISTS arg_OBJECTS)
        target_link_libraries(${objects} PRIVATE tilenca_flags)
        target_include_directories(${objects} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/include)
    endforeach()
    if(EMSCRIPTEN)
        return()
    endif()
    add_library(${name} SHARED)
    foreach(objects IN LISTS arg_OBJECTS)
        target_sources(${name} PRIVATE $<TARGET_OBJECTS:${objects}>)
    endforeach()
    if(arg_LTO AND TILENCA_CAN_LTO)
        set_target_properties(${name} ${arg_OBJECTS} PROPERTIES INTERPROCEDURAL_OPTIMIZATION ON)
    endif()
    set(exports ${TILENCA_C_API_DIR}/exports.map)
    target_link_libraries(${name} PRIVATE tilenca_flags)
    target_link_options(${name} PRIVATE -Wl,-Bsymbolic "-Wl,--version-script=${exports}")
    if(NOT TILENCA_SANITIZE) # the sanitizers' runtime is preloaded, so its symbols are undefined here
        target_link_options(${name} PRIVATE -Wl,--no-undefined)
    endif()
    set_target_properties(${name} PROPERTIES LINK_DEPENDS ${exports} LINKER_LANGUAGE CXX)

    file(GLOB headers ${CMAKE_CURRENT_SOURCE_DIR}/include/tilenca/*.h)
    if(TILENCA_BUILT)
        set_target_properties(${name} ${arg_OBJECTS} PROPERTIES EXCLUDE_FROM_ALL TRUE)
        add_library(${name}_built SHARED IMPORTED)
        set_target_properties(${name}_built PROPERTIES IMPORTED_LOCATION ${TILENCA_BUILT}/lib${name}.so)
        install(IMPORTED_RUNTIME_ARTIFACTS ${name}_built LIBRARY DESTINATION lib)
    else()
        install(TARGETS ${name} LIBRARY DESTINATION lib)
    endif()
    install(FILES ${headers} ${TILENCA_C_API_DIR}/include/tilenca/api.h DESTINATION lib/include/tilenca)
endfunction()
