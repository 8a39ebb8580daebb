# Writes OUT: the files of SOURCES (separated by |) one after another, each in a namespace of its own,
# after what they include. What several test files have in common - Catch2, the solver's headers, the
# templates both use - is then compiled once for all of them.
string(REPLACE "|" ";" SOURCES "${SOURCES}")
set(includes "")
set(bodies "")
foreach(source ${SOURCES})
    file(STRINGS ${source} lines REGEX "^#include ")
    list(APPEND includes ${lines})
    get_filename_component(name ${source} NAME)
    string(REGEX REPLACE "[^A-Za-z0-9]" "_" name ${name})
    # What a file says of undertow is said of the real one, also where it continues that namespace.
    string(APPEND bodies "namespace together_${name} {\n"
        "namespace undertow { using namespace ::undertow; namespace fem { using namespace ::undertow::fem; } }\n"
        "#include \"${source}\"\n}\n")
endforeach()
list(REMOVE_DUPLICATES includes)
string(REPLACE ";" "\n" includes "${includes}")
file(WRITE ${OUT} "${includes}\nnamespace undertow::fem {}\n${bodies}")
