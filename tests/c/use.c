// Normal use: ./use human.ply blob.ply
#include "test.h"

static int reports = 0;
static double last_fraction = 0;

static int32_t report(const char *stage, double fraction, void *user_data) {
    EXPECT(strlen(stage) > 0 && user_data == &reports);
    EXPECT(fraction >= last_fraction && fraction <= 1);
    last_fraction = fraction;
    ++reports;
    return 0;
}

static isym_result *detect(const isym_mesh *mesh, double symmetries) {
    isym_options *options;
    isym_progress *progress;
    isym_result *result;
    double value;
    OK(isym_options_new(&options));
    OK(isym_options_set(options, "symmetries", symmetries));
    OK(isym_options_get(options, "symmetries", &value));
    EXPECT(value == symmetries);
    OK(isym_progress_new(&progress));
    OK(isym_progress_set_callback(progress, report, &reports));
    reports = 0;
    last_fraction = 0;
    OK(isym_mesh_detect(mesh, options, progress, &result));
    OK(isym_progress_fraction(progress, &value));
    EXPECT(reports > 5 && last_fraction == 1 && value == 1);
    OK(isym_progress_free(progress));
    OK(isym_options_free(options));
    return result;
}

static void versions_and_options(void) {
    EXPECT(strcmp(isym_version(), ISYM_VERSION) == 0);
    EXPECT(strcmp(isym_status_name(ISYM_ERROR_MESH), "ISYM_ERROR_MESH") == 0);
    EXPECT(isym_option_count() >= 4);
    isym_options *options;
    OK(isym_options_new(&options));
    for (size_t index = 0; index < isym_option_count(); ++index) {
        isym_option_spec spec = {.size = sizeof spec};
        double value;
        OK(isym_option_describe(index, &spec));
        // A default of 0 below the minimum follows from the effort.
        EXPECT(spec.default_value == 0 || (spec.minimum <= spec.default_value && spec.default_value <= spec.maximum));
        EXPECT(strlen(spec.help) > 10 && (spec.is_expert == 0 || spec.is_expert == 1));
        EXPECT((spec.choices != NULL) == (strcmp(spec.name, "effort") == 0));
        OK(isym_options_get(options, spec.name, &value));
        EXPECT(value == spec.default_value);
        OK(isym_options_set(options, spec.name, spec.maximum));
        FAILS(ISYM_ERROR_OPTION, isym_options_set(options, spec.name, spec.maximum + 1));
    }
    const int8_t signs[3] = {1, -1, 0};
    OK(isym_options_set_known_signs(options, signs, 3));
    OK(isym_options_set_model(options, ""));
    OK(isym_options_free(options));
}

static isym_outcome outcome_of(const isym_result *result) {
    isym_outcome outcome = 9;
    OK(isym_result_outcome(result, &outcome));
    return outcome;
}

// The human's mesh is mirrored: the map is a bijection, its own inverse, and sides are swapped.
static void human(const char *path) {
    isym_mesh *mesh = read_mesh(path);
    size_t n, faces, corners, count, size, lines, points;
    OK(isym_mesh_size(mesh, &n, &faces, &corners));
    EXPECT(n == 13380 && faces > 13000);
    isym_result *result = detect(mesh, 1);
    OK(isym_result_symmetry_count(result, &count));
    EXPECT(count == 1);
    isym_summary summary = {.size = sizeof summary};
    OK(isym_result_summary(result, 0, &summary));
    EXPECT(summary.kind == ISYM_KIND_REFLECTION && summary.exact_share == 1 && summary.mean_confidence == 1);
    EXPECT(summary.plausibility > 0.5 && summary.plausibility <= 1);
    uint8_t continuous = 9;
    OK(isym_result_continuous_family(result, &continuous));
    EXPECT(continuous == 0);
    EXPECT(outcome_of(result) == ISYM_OUTCOME_FOUND);
    EXPECT(summary.paired_share == 1 && summary.shells_self_mirrored == 1);
    EXPECT(summary.shells_paired == 0 && summary.shells_alone == 0);

    uint32_t *partners = malloc(n * sizeof *partners);
    int8_t *sides = malloc(n);
    float *confidences = malloc(n * sizeof *confidences), *weights = malloc(3 * n * sizeof *weights);
    uint32_t *face = malloc(n * sizeof *face), *three = malloc(3 * n * sizeof *three);
    OK(isym_result_partners(result, 0, partners, n));
    OK(isym_result_sides(result, 0, sides, n));
    OK(isym_result_confidences(result, 0, confidences, n));
    OK(isym_result_surface_points(result, 0, face, three, weights, n));
    for (size_t v = 0; v < n; ++v) {
        EXPECT(partners[partners[v]] == v && sides[partners[v]] == -sides[v] && confidences[v] == 1);
        EXPECT(face[v] < faces && weights[3 * v] + weights[3 * v + 1] + weights[3 * v + 2] == 1);
    }

    OK(isym_result_curve_size(result, 0, &lines, &points));
    EXPECT(lines >= 1 && points > 50);
    uint32_t *offsets = malloc((lines + 1) * sizeof *offsets), *edges = malloc(2 * points * sizeof *edges);
    uint8_t *closed = malloc(lines);
    float *parameters = malloc(points * sizeof *parameters);
    OK(isym_result_curve(result, 0, offsets, closed, lines, edges, parameters, points));
    EXPECT(offsets[0] == 0 && offsets[lines] == points);

    OK(isym_result_report_size(result, &size));
    char *json = malloc(size);
    OK(isym_result_report(result, json, size));
    EXPECT(strlen(json) + 1 == size && strstr(json, "\"outcome\": \"found\"") && strstr(json, "human.ply"));

    // NULL options are the defaults: one symmetry is searched.
    isym_result *plain;
    double value;
    uint32_t *again = malloc(n * sizeof *again);
    OK(isym_options_get(NULL, "symmetries", &value));
    EXPECT(value == 1);
    OK(isym_mesh_detect(mesh, NULL, NULL, &plain));
    OK(isym_result_partners(plain, 0, again, n));
    EXPECT(memcmp(partners, again, n * sizeof *again) == 0);
    OK(isym_result_free(plain));

    // A stored map works as the found one does, and the result outlives its mesh.
    isym_result *stored;
    OK(isym_result_restore(mesh, summary.kind, partners, confidences, sides, face, three, weights, n, &stored));
    double *positions = malloc(3 * n * sizeof *positions), *first = malloc(3 * n * sizeof *first);
    double *second = malloc(3 * n * sizeof *second);
    OK(isym_mesh_positions(mesh, positions, 3 * n));
    OK(isym_mesh_free(mesh));
    isym_progress *progress;
    OK(isym_progress_new(&progress));
    const isym_mirroring wins = mirroring(ISYM_MERGE_POSITIVE_WINS, 0.5f, 0);
    OK(isym_result_symmetrize_positions(result, 0, &wins, positions, progress, first, n));
    OK(isym_result_symmetrize_positions(stored, 0, &wins, positions, NULL, second, n));
    EXPECT(memcmp(first, second, 3 * n * sizeof *first) == 0);
    OK(isym_progress_free(progress));
    OK(isym_result_free(stored));
    OK(isym_result_free(result));
    free(partners), free(sides), free(confidences), free(weights), free(face), free(three), free(offsets);
    free(edges), free(closed), free(parameters), free(json), free(positions), free(first), free(second), free(again);
}

// Deformed, the human keeps its map; a result of another connectivity is refused.
static void human_again(const char *path) {
    isym_mesh *mesh = read_mesh(path), *moved;
    isym_result *first = detect(mesh, 1), *second;
    size_t n, faces, corners, size;
    OK(isym_mesh_size(mesh, &n, &faces, &corners));
    double *positions = malloc(3 * n * sizeof *positions);
    uint32_t *offsets = malloc((faces + 1) * sizeof *offsets), *around = malloc(corners * sizeof *around);
    OK(isym_mesh_positions(mesh, positions, 3 * n));
    OK(isym_mesh_polygons(mesh, offsets, faces + 1, around, corners));
    for (size_t v = 0; v < n; ++v)
        positions[3 * v] += 0.2 * positions[3 * v + 1];
    OK(isym_mesh_from_polygons(positions, n, offsets, faces, around, corners, &moved));

    isym_options *options;
    isym_progress *progress;
    OK(isym_options_new(&options));
    OK(isym_progress_new(&progress));
    OK(isym_mesh_detect_again(moved, first, options, progress, &second));
    uint32_t *before = malloc(n * sizeof *before), *after = malloc(n * sizeof *after);
    OK(isym_result_partners(first, 0, before, n));
    OK(isym_result_partners(second, 0, after, n));
    EXPECT(memcmp(before, after, n * sizeof *before) == 0);
    OK(isym_result_report_size(second, &size));
    char *json = malloc(size);
    OK(isym_result_report(second, json, size));
    EXPECT(strstr(json, "\"kept\": true"));
    // And once more, from the second result, when the first is gone.
    isym_result *third;
    OK(isym_result_free(first));
    OK(isym_mesh_detect_again(mesh, second, NULL, NULL, &third));
    OK(isym_result_partners(third, 0, after, n));
    EXPECT(memcmp(before, after, n * sizeof *before) == 0);
    OK(isym_result_free(second));
    first = third;

    // One corner fewer is another connectivity.
    isym_mesh *cut;
    OK(isym_mesh_from_polygons(positions, n, offsets, faces - 1, around, offsets[faces - 1], &cut));
    FAILS(ISYM_ERROR_VALUE, isym_mesh_detect_again(cut, first, options, progress, &second));
    OK(isym_mesh_free(cut));
    OK(isym_mesh_free(moved));
    OK(isym_mesh_free(mesh));
    OK(isym_result_free(first));
    OK(isym_options_free(options));
    OK(isym_progress_free(progress));
    free(positions), free(offsets), free(around), free(before), free(after), free(json);
}

// Triangles of different shapes, none the mirror image of another.
static void no_symmetry(void) {
    enum { VERTICES = 600 };
    double positions[3 * VERTICES];
    uint32_t triangles[VERTICES];
    for (int k = 0; k < 3 * VERTICES; ++k)
        positions[k] = fmod(4321 * sin(k), 1);
    for (uint32_t v = 0; v < VERTICES; ++v)
        triangles[v] = v;
    isym_mesh *mesh;
    OK(isym_mesh_from_triangles(positions, VERTICES, triangles, VERTICES / 3, &mesh));
    isym_result *result = detect(mesh, 1);
    size_t count;
    OK(isym_result_symmetry_count(result, &count));
    EXPECT(count == 0 && outcome_of(result) == ISYM_OUTCOME_NONE);
    OK(isym_result_free(result));
    OK(isym_mesh_free(mesh));
}

// A lump without a symmetry is not found to have one; it may have a doubtful map.
static void lump(const char *path) {
    isym_mesh *mesh = read_mesh(path);
    isym_result *result = detect(mesh, 1);
    size_t count;
    OK(isym_result_symmetry_count(result, &count));
    EXPECT(outcome_of(result) != ISYM_OUTCOME_FOUND && (count == 0) == (outcome_of(result) == ISYM_OUTCOME_NONE));
    OK(isym_result_free(result));
    OK(isym_mesh_free(mesh));
}

// On the square everything has a closed form.
static void tools(void) {
    isym_mesh *mesh = square();
    isym_result *result = square_symmetry(mesh);
    uint8_t selected[9] = {1, 1, 0, 0, 0, 0, 0, 0, 0};
    OK(isym_result_mirror_selection(result, 0, selected, 0.5f, selected, 9));
    const uint8_t mirrored[9] = {0, 1, 1, 0, 0, 0, 0, 0, 0};
    EXPECT(memcmp(selected, mirrored, 9) == 0);
    uint8_t faces[4] = {1, 0, 0, 1}, colours[27];
    OK(isym_result_mirror_face_selection(result, 0, faces, 0.5f, faces, 4));
    EXPECT(!faces[0] && faces[1] && faces[2] && !faces[3]);
    OK(isym_result_pair_colours(result, 0, colours, 9));
    EXPECT(memcmp(colours, colours + 6, 3) == 0 && memcmp(colours, colours + 9, 3) != 0);

    double values[18], found[18];
    for (int i = 0; i < 18; ++i)
        values[i] = i;
    const isym_mirroring swap = mirroring(ISYM_MERGE_SWAP, 0, 0), wins = mirroring(ISYM_MERGE_NEGATIVE_WINS, 0, 1);
    OK(isym_result_mirror_values(result, 0, &swap, values, 2, found, 9));
    for (int i = 0; i < 18; ++i)
        EXPECT(found[i] == 2.0 * SQUARE_PARTNERS[i / 2] + i % 2);

    double push[27] = {0}, carried[27];
    push[0] = 0.5, push[1] = 0.25, push[2] = 0.125;
    OK(isym_result_carry_displacement(result, 0, &wins, SQUARE, push, carried, 9));
    EXPECT(carried[0] == 0.5 && carried[1] == 0.25 && carried[2] == 0.125);
    EXPECT(fabs(carried[6] + 0.5) + fabs(carried[7] - 0.25) + fabs(carried[8] - 0.125) < 1e-12);
    OK(isym_result_free(result));
    OK(isym_mesh_free(mesh));
}

static void arrays(void) {
    isym_mesh *quads = square(), *triangles, *single, *turned;
    uint64_t first, second;
    float positions[27];
    for (int i = 0; i < 27; ++i)
        positions[i] = (float)SQUARE[i];
    const uint32_t cut[24] = {0, 1, 4, 0, 4, 3, 1, 2, 4, 2, 5, 4, 3, 4, 6, 4, 7, 6, 4, 5, 8, 4, 8, 7};
    const size_t live = isym_handle_count();
    OK(isym_mesh_from_triangles(SQUARE, 9, cut, 8, &triangles));
    EXPECT(isym_handle_count() == live + 1);
    OK(isym_mesh_from_triangles_f32(positions, 9, cut, 8, &single));
    OK(isym_mesh_from_polygons_f32(positions, 9, SQUARE_OFFSETS, 4, SQUARE_QUADS, 16, &turned));
    OK(isym_mesh_connectivity_hash(triangles, &first));
    OK(isym_mesh_connectivity_hash(single, &second));
    EXPECT(first == second);
    OK(isym_mesh_connectivity_hash(quads, &second));
    EXPECT(first != second);
    double copied[27];
    OK(isym_mesh_positions(single, copied, 27));
    EXPECT(memcmp(copied, SQUARE, sizeof copied) == 0);
    uint32_t offsets[5], corners[16];
    OK(isym_mesh_polygons(turned, offsets, 5, corners, 16));
    EXPECT(memcmp(corners, SQUARE_QUADS, sizeof corners) == 0 && offsets[4] == 16);

    isym_eigen *pairs;
    size_t n, count;
    OK(isym_mesh_eigen(quads, 4, NULL, &pairs));
    OK(isym_eigen_size(pairs, &n, &count));
    EXPECT(n == 9 && count == 4);
    double eigenvalues[4], functions[36], mass[9], total = 0, norm = 0;
    OK(isym_eigen_read(pairs, eigenvalues, functions, mass, 9, 4));
    for (int v = 0; v < 9; ++v)
        total += mass[v], norm += mass[v] * functions[4 * v] * functions[4 * v];
    EXPECT(fabs(total - 1) < 1e-12 && fabs(norm - 1) < 1e-9 && eigenvalues[0] > 1 && eigenvalues[0] <= eigenvalues[1]);
    OK(isym_eigen_free(pairs));
    OK(isym_mesh_free(quads));
    OK(isym_mesh_free(triangles));
    OK(isym_mesh_free(single));
    OK(isym_mesh_free(turned));
}

int main(int count, char **arguments) {
    EXPECT(count == 3);
    versions_and_options();
    tools();
    arrays();
    human(arguments[1]);
    human_again(arguments[1]);
    no_symmetry();
    lump(arguments[2]);
    EXPECT(isym_handle_count() == 0);
    return 0;
}
