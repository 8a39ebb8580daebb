add_executable(bench_contact_cost ${CMAKE_CURRENT_LIST_DIR}/contact_cost.cpp)
target_link_libraries(bench_contact_cost PRIVATE undertow_contact)

add_executable(bench_contact_stability ${CMAKE_CURRENT_LIST_DIR}/contact_stability.cpp
    ${CMAKE_CURRENT_LIST_DIR}/../unit/contact/scene.cpp)
target_link_libraries(bench_contact_stability PRIVATE undertow_contact)

# The search against Embree's point query, where the library is installed (Debian: libembree-dev).
find_package(embree 3 QUIET)
if(embree_FOUND)
    add_executable(bench_contact_embree ${CMAKE_CURRENT_LIST_DIR}/contact_embree.cpp)
    target_link_libraries(bench_contact_embree PRIVATE undertow_contact embree)
endif()
