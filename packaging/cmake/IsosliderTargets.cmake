# Warnings, sanitizers and test registration as interface targets and functions; nothing edits CMAKE_CXX_FLAGS.
add_library(isoslider_options INTERFACE)
target_compile_features(isoslider_options INTERFACE cxx_std_20)
target_compile_options(isoslider_options INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wno-missing-field-initializers
  # GCC 12 sees overflows in inlined vectors and strings that are not there
  $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow> $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)
# Population counts and bit scans as instructions: in every PC since 2009.
if(ISOSLIDER_ARCH AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  target_compile_options(isoslider_options INTERFACE -march=${ISOSLIDER_ARCH})
endif()
if(ISOSLIDER_WARNINGS_AS_ERRORS)
  target_compile_options(isoslider_options INTERFACE -Werror)
endif()
# asan-ubsan | tsan | fuzzer, empty for none
if(ISOSLIDER_SANITIZER STREQUAL "asan-ubsan")
  target_compile_options(isoslider_options INTERFACE -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(isoslider_options INTERFACE -fsanitize=address,undefined)
elseif(ISOSLIDER_SANITIZER STREQUAL "tsan")
  target_compile_options(isoslider_options INTERFACE -fsanitize=thread -fno-omit-frame-pointer)
  target_link_options(isoslider_options INTERFACE -fsanitize=thread)
elseif(ISOSLIDER_SANITIZER STREQUAL "fuzzer") # libFuzzer itself is linked where targets are: see tests/fuzz
  target_compile_options(isoslider_options INTERFACE -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(isoslider_options INTERFACE -fsanitize=address,undefined)
elseif(NOT ISOSLIDER_SANITIZER STREQUAL "")
  message(FATAL_ERROR "ISOSLIDER_SANITIZER is '${ISOSLIDER_SANITIZER}'; known: asan-ubsan, tsan, fuzzer")
endif()

# isoslider_library(NAME SOURCES ... [HEADERS ...])
function(isoslider_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;HEADERS" ${ARGN})
  add_library(isoslider_${name} STATIC ${ARG_SOURCES})
  add_library(Isoslider::${name} ALIAS isoslider_${name})
  target_sources(isoslider_${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${ARG_HEADERS})
  target_include_directories(isoslider_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(isoslider_${name} PRIVATE isoslider_options)
  target_compile_features(isoslider_${name} PUBLIC cxx_std_20)
endfunction()

# isoslider_add_test(NAME LABELS ... SOURCES ... LIBRARIES ... [TIMEOUT seconds])
# One executable of GoogleTest cases, each registered with its labels.
function(isoslider_add_test name)
  cmake_parse_arguments(ARG "NO_MAIN" "TIMEOUT;WORKING_DIRECTORY" "LABELS;SOURCES;LIBRARIES;ENVIRONMENT" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 60)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE isoslider_options ${ARG_LIBRARIES} GTest::gtest GTest::gmock)
  if(NOT ARG_NO_MAIN)
    target_link_libraries(${name} PRIVATE GTest::gtest_main)
  endif()
  target_compile_definitions(${name} PRIVATE
    ISOSLIDER_SHARED_DIR="${ISOSLIDER_SHARED_DIR}" ISOSLIDER_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60
    PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}" ENVIRONMENT "${ARG_ENVIRONMENT}")
endfunction()
