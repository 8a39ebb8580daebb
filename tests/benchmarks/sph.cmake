add_executable(bench_sph_throughput ${CMAKE_CURRENT_LIST_DIR}/sph_throughput.cpp
    ${CMAKE_CURRENT_LIST_DIR}/dam_break_scene.cpp ${CMAKE_CURRENT_LIST_DIR}/machine_peaks.cpp)
target_compile_definitions(bench_sph_throughput PRIVATE UNDERTOW_CASES="${CMAKE_SOURCE_DIR}/cases")
target_link_libraries(bench_sph_throughput PRIVATE undertow_sph)
