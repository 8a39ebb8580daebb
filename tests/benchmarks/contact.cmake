add_executable(bench_contact_cost ${CMAKE_CURRENT_LIST_DIR}/contact_cost.cpp)
target_link_libraries(bench_contact_cost PRIVATE undertow_contact)

add_executable(bench_contact_stability ${CMAKE_CURRENT_LIST_DIR}/contact_stability.cpp
    ${CMAKE_CURRENT_LIST_DIR}/../unit/contact/scene.cpp)
target_link_libraries(bench_contact_stability PRIVATE undertow_contact)
