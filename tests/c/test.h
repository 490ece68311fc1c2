// What the C tests share: checks that say where they failed, and a small mesh whose mirror image is known.
#ifndef INTRINSYM_TESTS_TEST_H
#define INTRINSYM_TESTS_TEST_H

#include <isym.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPECT(condition)                                                                          \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            fprintf(stderr, "%s:%d: not so: %s (last error: %s)\n", __FILE__, __LINE__, #condition, \
                    isym_error_message());                                                         \
            exit(1);                                                                               \
        }                                                                                          \
    } while (0)

#define OK(call) EXPECT((call) == ISYM_OK)

// The status, and that its text is there.
#define FAILS(expected, call)                      \
    do {                                           \
        EXPECT((call) == (expected));              \
        EXPECT(strlen(isym_error_message()) > 5);  \
    } while (0)

// Enumerations have one width, in C and in C++, whatever the compiler would choose.
#ifdef __cplusplus
#define HAS_32_BITS(type) static_assert(sizeof(type) == 4, "32 bits")
#else
#define HAS_32_BITS(type) _Static_assert(sizeof(type) == 4, "32 bits")
#endif
HAS_32_BITS(isym_status);
HAS_32_BITS(isym_kind);
HAS_32_BITS(isym_outcome);
HAS_32_BITS(isym_merge);

// A flat square of 2 x 2 cells, mirrored in x: vertices 0 1 2 / 3 4 5 / 6 7 8.
static const double SQUARE[27] = {-1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 1, 0, 0, 1, 0, 1, 1, 0, -1, 2, 0, 0, 2, 0, 1, 2, 0};
static const uint32_t SQUARE_QUADS[16] = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6, 4, 5, 8, 7};
static const uint32_t SQUARE_OFFSETS[5] = {0, 4, 8, 12, 16};
static const uint32_t SQUARE_PARTNERS[9] = {2, 1, 0, 5, 4, 3, 8, 7, 6};

static inline isym_mesh *square(void) {
    isym_mesh *mesh;
    OK(isym_mesh_from_polygons(SQUARE, 9, SQUARE_OFFSETS, 4, SQUARE_QUADS, 16, &mesh));
    return mesh;
}

// The square's mirror map as a stored one.
static inline isym_result *square_symmetry(const isym_mesh *mesh) {
    static const int8_t sides[9] = {-1, 0, 1, -1, 0, 1, -1, 0, 1};
    float confidences[9], weights[27];
    uint32_t faces[9], corners[27];
    for (int vertex = 0; vertex < 9; ++vertex) {
        confidences[vertex] = 1;
        faces[vertex] = 0;
        for (int corner = 0; corner < 3; ++corner) {
            corners[3 * vertex + corner] = SQUARE_PARTNERS[vertex];
            weights[3 * vertex + corner] = corner == 0;
        }
    }
    isym_result *result;
    OK(isym_result_restore(mesh, ISYM_KIND_REFLECTION, SQUARE_PARTNERS, confidences, sides, faces, corners, weights, 9,
                           &result));
    return result;
}

static inline isym_mirroring mirroring(isym_merge merge, float minimum_confidence, int32_t weight_by_confidence) {
    isym_mirroring how = {sizeof how, merge, minimum_confidence, weight_by_confidence};
    return how;
}

static inline isym_mesh *read_mesh(const char *path) {
    isym_mesh *mesh;
    OK(isym_mesh_read(path, &mesh));
    return mesh;
}

#endif
