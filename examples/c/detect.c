// Prints the mirror image of a few vertices of a mesh file: ./detect human.ply
#include <isym.h>
#include <stdio.h>
#include <stdlib.h>

// Ends the program with the library's own words where a call fails.
static void check(isym_status status) {
    if (status != ISYM_OK) {
        fprintf(stderr, "%s: %s\n", isym_status_name(status), isym_error_message());
        exit(2);
    }
}

int main(int count, char **arguments) {
    isym_mesh *mesh;
    isym_result *result;
    size_t vertices, faces, corners, found;

    check(isym_mesh_read(count > 1 ? arguments[1] : "human.ply", &mesh));
    // No options: the defaults. No progress: nothing is reported.
    check(isym_mesh_detect(mesh, NULL, NULL, &result));
    check(isym_mesh_size(mesh, &vertices, &faces, &corners));
    check(isym_result_symmetry_count(result, &found));
    uint32_t *partners = calloc(vertices, sizeof *partners);
    if (found > 0) {
        check(isym_result_partners(result, 0, partners, vertices));
        for (size_t vertex = 0; vertex < vertices; vertex += vertices / 8 + 1)
            if (partners[vertex] != ISYM_NONE)
                printf("vertex %zu mirrors to vertex %u\n", vertex, (unsigned)partners[vertex]);
    } else {
        puts("no symmetry found");
    }

    free(partners);
    isym_result_free(result);
    isym_mesh_free(mesh);
    return found > 0 ? 0 : 1;
}
