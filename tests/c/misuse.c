// Misuse: NULL everywhere, wrong lengths, freed and foreign handles, bad numbers. Each is an error with a text,
// and nothing is written. ./misuse quadruped.ply
#include "test.h"

#define UNTOUCHED ((void *)0x5a5a5a50)

static void null_is_an_error(const isym_mesh *mesh, const isym_result *result, isym_options *options,
                             isym_progress *progress) {
    isym_mesh *made = UNTOUCHED;
    isym_result *found = UNTOUCHED;
    isym_eigen *pairs = UNTOUCHED;
    double number;
    FAILS(ISYM_ERROR_NULL, isym_option_describe(0, NULL));
    FAILS(ISYM_ERROR_NULL, isym_options_new(NULL));
    FAILS(ISYM_ERROR_NULL, isym_options_set(NULL, "samples", 500));
    FAILS(ISYM_ERROR_NULL, isym_options_set(options, NULL, 500));
    FAILS(ISYM_ERROR_NULL, isym_options_get(options, "samples", NULL));
    FAILS(ISYM_ERROR_NULL, isym_options_get(NULL, "samples", NULL));
    FAILS(ISYM_ERROR_NULL, isym_options_set_model(options, NULL));
    FAILS(ISYM_ERROR_NULL, isym_options_set_known_signs(options, NULL, 0));
    FAILS(ISYM_ERROR_NULL, isym_progress_new(NULL));
    FAILS(ISYM_ERROR_NULL, isym_progress_set_callback(progress, NULL, NULL));
    FAILS(ISYM_ERROR_NULL, isym_progress_fraction(NULL, &number));
    FAILS(ISYM_ERROR_NULL, isym_progress_fraction(progress, NULL));
    FAILS(ISYM_ERROR_NULL, isym_progress_cancel(NULL));
    FAILS(ISYM_ERROR_NULL, isym_mesh_from_triangles(NULL, 9, SQUARE_QUADS, 4, &made));
    FAILS(ISYM_ERROR_NULL, isym_mesh_from_triangles(SQUARE, 9, NULL, 4, &made));
    FAILS(ISYM_ERROR_NULL, isym_mesh_from_triangles(SQUARE, 9, SQUARE_QUADS, 4, NULL));
    FAILS(ISYM_ERROR_NULL, isym_mesh_from_polygons(SQUARE, 9, NULL, 4, SQUARE_QUADS, 16, &made));
    FAILS(ISYM_ERROR_NULL, isym_mesh_read(NULL, &made));
    FAILS(ISYM_ERROR_NULL, isym_mesh_read("mesh.ply", NULL));
    FAILS(ISYM_ERROR_NULL, isym_mesh_size(mesh, NULL, NULL, NULL));
    FAILS(ISYM_ERROR_NULL, isym_mesh_positions(mesh, NULL, 27));
    FAILS(ISYM_ERROR_NULL, isym_mesh_connectivity_hash(mesh, NULL));
    FAILS(ISYM_ERROR_NULL, isym_mesh_detect(NULL, options, progress, &found));
    FAILS(ISYM_ERROR_NULL, isym_mesh_detect(mesh, options, progress, NULL));
    FAILS(ISYM_ERROR_NULL, isym_mesh_detect(mesh, NULL, NULL, NULL));
    FAILS(ISYM_ERROR_NULL, isym_mesh_eigen(mesh, 4, NULL, NULL));
    FAILS(ISYM_ERROR_NULL, isym_mesh_detect_again(mesh, NULL, options, progress, &found));
    FAILS(ISYM_ERROR_NULL, isym_mesh_detect_again(mesh, result, options, progress, NULL));
    FAILS(ISYM_ERROR_NULL, isym_result_partners(result, 0, NULL, 9));
    FAILS(ISYM_ERROR_NULL, isym_result_report(result, NULL, 9));
    FAILS(ISYM_ERROR_NULL, isym_result_continuous_family(result, NULL));
    FAILS(ISYM_ERROR_NULL, isym_result_outcome(result, NULL));
    FAILS(ISYM_ERROR_NULL, isym_result_mirror_values(result, 0, NULL, SQUARE, 3, NULL, 9));
    EXPECT(made == UNTOUCHED && found == UNTOUCHED && pairs == UNTOUCHED);
}

static void null_is_nothing_to_free(void) {
    const size_t live = isym_handle_count();
    OK(isym_options_free(NULL));
    OK(isym_progress_free(NULL));
    OK(isym_mesh_free(NULL));
    OK(isym_result_free(NULL));
    OK(isym_eigen_free(NULL));
    EXPECT(isym_handle_count() == live);
}

static void wrong_lengths(const isym_mesh *mesh, const isym_result *result) {
    uint32_t partners[10] = {77};
    double values[30] = {77};
    uint8_t selected[10] = {77};
    char text[4] = "abc";
    const isym_mirroring swap = mirroring(ISYM_MERGE_SWAP, 0, 0);
    FAILS(ISYM_ERROR_LENGTH, isym_result_partners(result, 0, partners, 10));
    FAILS(ISYM_ERROR_LENGTH, isym_result_partners(result, 0, partners, 8));
    FAILS(ISYM_ERROR_LENGTH, isym_result_partners(result, 0, partners, SIZE_MAX));
    FAILS(ISYM_ERROR_LENGTH, isym_mesh_positions(mesh, values, 9));
    FAILS(ISYM_ERROR_LENGTH, isym_result_report(result, text, 4));
    FAILS(ISYM_ERROR_LENGTH, isym_result_mirror_selection(result, 0, selected, 0, selected, 10));
    FAILS(ISYM_ERROR_LENGTH, isym_result_mirror_face_selection(result, 0, selected, 0, selected, 5));
    FAILS(ISYM_ERROR_LENGTH, isym_result_curve_distances(result, 0, SQUARE, values, 8));
    FAILS(ISYM_ERROR_LENGTH, isym_result_pair_colours(result, 0, selected, 10));
    FAILS(ISYM_ERROR_LENGTH, isym_result_mirror_values(result, 0, &swap, SQUARE, 0, values, 9));
    FAILS(ISYM_ERROR_LENGTH, isym_result_mirror_values(result, 0, &swap, SQUARE, SIZE_MAX / 2, values, 9));
    EXPECT(partners[0] == 77 && values[0] == 77 && selected[0] == 77 && strcmp(text, "abc") == 0);
}

static void wrong_values(const isym_mesh *mesh, const isym_result *result, isym_options *options) {
    isym_mesh *made = UNTOUCHED;
    isym_summary summary = {.size = sizeof summary};
    isym_option_spec spec = {.size = sizeof spec};
    double values[27], broken[27];
    memcpy(broken, SQUARE, sizeof broken);
    broken[4] = NAN;
    uint32_t corners[16];
    memcpy(corners, SQUARE_QUADS, sizeof corners);
    corners[5] = 9;
    const uint32_t falling[5] = {0, 8, 4, 12, 16};
    FAILS(ISYM_ERROR_MESH, isym_mesh_from_polygons(broken, 9, SQUARE_OFFSETS, 4, SQUARE_QUADS, 16, &made));
    FAILS(ISYM_ERROR_MESH, isym_mesh_from_polygons(SQUARE, 9, SQUARE_OFFSETS, 4, corners, 16, &made));
    FAILS(ISYM_ERROR_MESH, isym_mesh_from_polygons(SQUARE, 9, falling, 4, SQUARE_QUADS, 16, &made));
    FAILS(ISYM_ERROR_MESH, isym_mesh_from_polygons(SQUARE, 9, SQUARE_OFFSETS, 3, SQUARE_QUADS, 16, &made));
    FAILS(ISYM_ERROR_MESH, isym_mesh_from_triangles(SQUARE, 0, SQUARE_QUADS, 0, &made));
    FAILS(ISYM_ERROR_LIMIT, isym_mesh_from_triangles(SQUARE, 1u << 31, SQUARE_QUADS, 4, &made));
    FAILS(ISYM_ERROR_LENGTH, isym_mesh_from_triangles(SQUARE, 9, SQUARE_QUADS, SIZE_MAX, &made));
    FAILS(ISYM_ERROR_FILE, isym_mesh_read("no/such/file.ply", &made));
    FAILS(ISYM_ERROR_TEXT, isym_mesh_read("\xff\xfe.ply", &made));
    FAILS(ISYM_ERROR_OPTION, isym_options_set(options, "sample", 500));
    FAILS(ISYM_ERROR_OPTION, isym_options_set(options, "samples", 500.5));
    FAILS(ISYM_ERROR_OPTION, isym_options_set(options, "samples", NAN));
    FAILS(ISYM_ERROR_OPTION, isym_options_set(options, "samples", -1));
    const int8_t signs[2] = {1, 2};
    FAILS(ISYM_ERROR_OPTION, isym_options_set_known_signs(options, signs, 2));
    FAILS(ISYM_ERROR_INDEX, isym_option_describe(1000, &spec));
    FAILS(ISYM_ERROR_INDEX, isym_result_summary(result, 1, &summary));
    const isym_mirroring mirrorings[4] = {mirroring(9, 0, 0), mirroring(ISYM_MERGE_SWAP, 2, 0),
                                          mirroring(ISYM_MERGE_SWAP, NAN, 0), mirroring(ISYM_MERGE_SWAP, 0, 7)};
    const isym_status expected[4] = {ISYM_ERROR_VALUE, ISYM_ERROR_OPTION, ISYM_ERROR_OPTION, ISYM_ERROR_VALUE};
    for (int i = 0; i < 4; ++i)
        FAILS(expected[i], isym_result_mirror_values(result, 0, &mirrorings[i], SQUARE, 3, values, 9));
    const isym_mirroring swap = mirroring(ISYM_MERGE_SWAP, 0, 0);
    FAILS(ISYM_ERROR_VALUE, isym_result_carry_displacement(result, 0, &swap, broken, SQUARE, values, 9));
    FAILS(ISYM_ERROR_ALIGNMENT, isym_mesh_positions(mesh, (double *)(void *)((char *)values + 1), 27));
    EXPECT(made == UNTOUCHED);
}

// A size that was not set, and those of other versions of the structs. Nothing of the struct is written.
static void wrong_sizes(const isym_result *result) {
    const size_t sizes[3] = {0, sizeof(size_t), SIZE_MAX};
    double values[27] = {77};
    for (int i = 0; i < 3; ++i) {
        isym_summary summary = {.size = sizes[i], .shells_alone = 77};
        isym_option_spec spec = {.size = sizes[i], .is_expert = 77};
        isym_mirroring how = mirroring(ISYM_MERGE_SWAP, 0, 0);
        how.size = sizes[i];
        FAILS(ISYM_ERROR_SIZE, isym_result_summary(result, 0, &summary));
        EXPECT(strstr(isym_error_message(), "summary"));
        FAILS(ISYM_ERROR_SIZE, isym_option_describe(0, &spec));
        FAILS(ISYM_ERROR_SIZE, isym_result_mirror_values(result, 0, &how, SQUARE, 3, values, 9));
        FAILS(ISYM_ERROR_SIZE, isym_result_carry_displacement(result, 0, &how, SQUARE, SQUARE, values, 9));
        EXPECT(summary.shells_alone == 77 && spec.is_expert == 77 && values[0] == 77);
    }
}

static void stored_maps_are_looked_at(const isym_mesh *mesh) {
    int8_t sides[9] = {0};
    float confidences[9] = {0}, weights[27] = {0};
    uint32_t faces[9] = {0}, corners[27] = {0};
    uint32_t partners[9];
    for (int v = 0; v < 9; ++v)
        partners[v] = SQUARE_PARTNERS[v], weights[3 * v] = 1;
    isym_result *made = UNTOUCHED;
#define RESTORE isym_result_restore(mesh, 0, partners, confidences, sides, faces, corners, weights, 9, &made)
    partners[3] = 9;
    FAILS(ISYM_ERROR_VALUE, RESTORE);
    EXPECT(strstr(isym_error_message(), "vertex 3"));
    partners[3] = ISYM_NONE - 1;
    FAILS(ISYM_ERROR_VALUE, RESTORE);
    partners[3] = 5, sides[2] = 4;
    FAILS(ISYM_ERROR_VALUE, RESTORE);
    sides[2] = 0, confidences[1] = NAN;
    FAILS(ISYM_ERROR_VALUE, RESTORE);
    confidences[1] = 0, corners[8] = 9;
    FAILS(ISYM_ERROR_VALUE, RESTORE);
    corners[8] = 0, weights[0] = 0.5f;
    FAILS(ISYM_ERROR_VALUE, RESTORE);
    weights[0] = 1, faces[8] = 4;
    FAILS(ISYM_ERROR_VALUE, RESTORE);
    FAILS(ISYM_ERROR_VALUE, isym_result_restore(mesh, 5, partners, confidences, sides, faces, corners, weights, 9, &made));
    FAILS(ISYM_ERROR_LENGTH, isym_result_restore(mesh, 0, partners, confidences, sides, faces, corners, weights, 8, &made));
    EXPECT(made == UNTOUCHED);
    faces[8] = 3;
    OK(RESTORE);
    OK(isym_result_free(made));
}

static void freed_and_foreign_handles(const char *path) {
    isym_mesh *mesh = read_mesh(path);
    isym_options *options;
    isym_progress *progress;
    isym_result *found = UNTOUCHED;
    size_t count = 77;
    OK(isym_options_new(&options));
    OK(isym_progress_new(&progress));
    OK(isym_mesh_free(mesh));
    FAILS(ISYM_ERROR_HANDLE, isym_mesh_free(mesh));
    FAILS(ISYM_ERROR_HANDLE, isym_mesh_detect(mesh, options, progress, &found));
    FAILS(ISYM_ERROR_HANDLE, isym_mesh_size((isym_mesh *)(void *)options, &count, &count, &count));
    FAILS(ISYM_ERROR_HANDLE, isym_result_symmetry_count((isym_result *)(void *)&count, &count));
    OK(isym_options_free(options));
    FAILS(ISYM_ERROR_HANDLE, isym_options_set(options, "samples", 500));
    OK(isym_progress_free(progress));
    FAILS(ISYM_ERROR_HANDLE, isym_progress_cancel(progress));
    EXPECT(found == UNTOUCHED && count == 77);
}

// A half turn has no sides that could win; a model that is none says so when it is used.
static void what_cannot_be(const isym_mesh *mesh, isym_options *options, const char *path) {
    isym_progress *progress;
    isym_result *half_turn, *found = UNTOUCHED;
    float zeros[27] = {0};
    uint32_t none[9];
    const uint32_t indices[27] = {0};
    const int8_t sides[9] = {0};
    for (int v = 0; v < 9; ++v)
        none[v] = ISYM_NONE;
    OK(isym_result_restore(mesh, ISYM_KIND_HALF_TURN, none, zeros, sides, indices, indices, zeros, 9, &half_turn));
    double values[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    const isym_mirroring wins = mirroring(ISYM_MERGE_POSITIVE_WINS, 0, 0), swap = mirroring(ISYM_MERGE_SWAP, 0, 0);
    FAILS(ISYM_ERROR_OPTION, isym_result_mirror_values(half_turn, 0, &wins, values, 1, values, 9));
    OK(isym_result_mirror_values(half_turn, 0, &swap, values, 1, values, 9));
    EXPECT(values[0] == 1 && values[8] == 9);
    isym_summary summary = {.size = sizeof summary};
    OK(isym_result_summary(half_turn, 0, &summary));
    EXPECT(summary.kind == ISYM_KIND_HALF_TURN && summary.plausibility == 1);
    FAILS(ISYM_ERROR_NULL, isym_result_summary(half_turn, 0, NULL));
    FAILS(ISYM_ERROR_INDEX, isym_result_summary(half_turn, 1, &summary));
    OK(isym_result_free(half_turn));
    FAILS(ISYM_ERROR_VALUE, isym_result_restore(mesh, (isym_kind)2, none, zeros, sides, indices, indices, zeros, 9,
                                                &found));
    EXPECT(found == UNTOUCHED);

    isym_mesh *animal = read_mesh(path);
    OK(isym_progress_new(&progress));
    OK(isym_options_set_model(options, "no/such/model.onnx"));
    const isym_status status = isym_mesh_detect(animal, options, progress, &found);
    EXPECT(status == ISYM_ERROR_FILE || status == ISYM_ERROR_MODEL);
    OK(isym_options_set_model(options, ""));
    // Cancelled before it began.
    OK(isym_progress_cancel(progress));
    FAILS(ISYM_ERROR_CANCELLED, isym_mesh_detect(animal, options, progress, &found));
    EXPECT(found == UNTOUCHED);
    OK(isym_progress_free(progress));
    OK(isym_mesh_free(animal));
}

int main(int count, char **arguments) {
    EXPECT(count == 2);
    isym_mesh *mesh = square();
    isym_result *result = square_symmetry(mesh);
    isym_options *options;
    isym_progress *progress;
    OK(isym_options_new(&options));
    OK(isym_progress_new(&progress));
    null_is_an_error(mesh, result, options, progress);
    null_is_nothing_to_free();
    wrong_lengths(mesh, result);
    wrong_values(mesh, result, options);
    wrong_sizes(result);
    stored_maps_are_looked_at(mesh);
    freed_and_foreign_handles(arguments[1]);
    what_cannot_be(mesh, options, arguments[1]);
    OK(isym_progress_free(progress));
    OK(isym_options_free(options));
    OK(isym_result_free(result));
    OK(isym_mesh_free(mesh));
    EXPECT(isym_handle_count() == 0);
    EXPECT(strcmp(isym_status_name(12345), "unknown status") == 0);
    return 0;
}
