# compile_as_one(TARGET NAME [-O<n>] FILE...): files of a library as one translation unit, so that the headers they
# share are read once and their templates compiled once: a third of the time of one by one. For what is small and
# seldom changes; kernels that every step runs keep units of their own. Files of a group share the names of their
# unnamed namespaces. The level of optimization is for what never is hot.
option(UNDERTOW_TOGETHER "Compile small source files several at a time: half the CPU, coarser rebuilds" ON)
function(compile_as_one target name)
    set(files ${ARGN})
    set(options "")
    list(GET files 0 first)
    if(first MATCHES "^-O")
        list(POP_FRONT files)
        if(NOT UNDERTOW_SANITIZE)   # has a level of its own
            set(options ${first})
        endif()
    endif()
    set(unit ${CMAKE_CURRENT_BINARY_DIR}/${name}_as_one.cpp)
    set(compiled ${files})
    if(UNDERTOW_TOGETHER)
        set(text "")
        foreach(file ${files})
            string(APPEND text "#include \"${CMAKE_CURRENT_SOURCE_DIR}/${file}\"\n")
        endforeach()
        file(GENERATE OUTPUT ${unit} CONTENT "${text}")
        set_source_files_properties(${files} PROPERTIES HEADER_FILE_ONLY ON)
        target_sources(${target} PRIVATE ${unit})
        set(compiled ${unit})
    endif()
    set_source_files_properties(${compiled} PROPERTIES COMPILE_OPTIONS "${options}")
endfunction()
