/// @file
/// Intrinsym: the intrinsic mirror symmetry of a surface mesh. This is the C library's only header.
///
/// Made by cbindgen from capi/src (`make header`); do not edit. The comments are Doxygen's.
///
/// Every function that can fail returns an isym_status: ISYM_OK, or a code and, in this thread, a text
/// (isym_error_message). On failure nothing is written. Any call may answer, beside the codes that stand with it,
/// ISYM_ERROR_NULL, ISYM_ERROR_HANDLE, ISYM_ERROR_LENGTH, ISYM_ERROR_ALIGNMENT, ISYM_ERROR_TEXT and ISYM_ERROR_INTERNAL.
///
/// A NULL is an error, but for user_data, for options (the defaults), for progress (none), and for what is freed. Sizes of
/// arrays are in elements. The first field of each struct is its size: set it to sizeof before the call.
///
/// Handles come from functions whose last argument is a pointer to one, and are freed by the function of their kind; a freed
/// handle is an error and no crash. Functions may be called from several threads at once, on the same handles too.


#ifndef INTRINSYM_ISYM_H
#define INTRINSYM_ISYM_H

#include <stddef.h>
#include <stdint.h>

/// The version of this header; isym_version() is the version of the library that is running.
#define ISYM_VERSION "0.1.0"
#define ISYM_VERSION_MAJOR 0
#define ISYM_VERSION_MINOR 1
#define ISYM_VERSION_PATCH 0

/// What stands before each function. Programs that link the static library on Windows define ISYM_STATIC.
#ifndef ISYM_API
#if defined(_WIN32) && !defined(ISYM_STATIC)
#define ISYM_API __declspec(dllimport)
#elif defined(__GNUC__)
#define ISYM_API __attribute__((visibility("default")))
#else
#define ISYM_API
#endif
#endif


/// No such element, in arrays of indices.
#define ISYM_NONE UINT32_MAX

/// What a call answers. A code is never given another meaning; treat one that you do not know as an error.
enum isym_status
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
    /// Done.
    ISYM_OK = 0,
    /// A pointer argument is NULL.
    ISYM_ERROR_NULL = 1,
    /// A handle was freed already, was never made, or is of another kind.
    ISYM_ERROR_HANDLE = 2,
    /// A length does not fit: an array has not the length that the mesh or result asks for.
    ISYM_ERROR_LENGTH = 3,
    /// An index is past the end: a symmetry or an option that does not exist.
    ISYM_ERROR_INDEX = 4,
    /// A text is not UTF-8.
    ISYM_ERROR_TEXT = 5,
    /// A value in an array, or a constant, is not among the accepted ones.
    ISYM_ERROR_VALUE = 6,
    /// A pointer is not aligned to its type.
    ISYM_ERROR_ALIGNMENT = 7,
    /// The `size` of a struct is not that of this library's: it was not set, or the header is of another version.
    ISYM_ERROR_SIZE = 8,
    /// The mesh cannot be used; the text names the element and the reason.
    ISYM_ERROR_MESH = 16,
    /// The file cannot be read or written; the text names the line or byte and what to do.
    ISYM_ERROR_FILE = 17,
    /// An option is unknown or outside its range.
    ISYM_ERROR_OPTION = 18,
    /// The sign network's model cannot be used.
    ISYM_ERROR_MODEL = 19,
    /// The mesh or file is larger than the limits allow.
    ISYM_ERROR_LIMIT = 20,
    /// The call was cancelled, by `isym_progress_cancel` or by the progress callback.
    ISYM_ERROR_CANCELLED = 21,
    /// The progress callback threw a C++ exception, which was stopped at the border.
    ISYM_ERROR_CALLBACK = 22,
    /// A defect of the library; please report it with the text. Handles stay usable.
    ISYM_ERROR_INTERNAL = 32,
};
#ifndef __cplusplus
typedef int32_t isym_status;
#endif // __cplusplus

/// What was found.
enum isym_outcome
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
    /// At least one symmetry.
    ISYM_OUTCOME_FOUND = 0,
    /// A map is given, and the report's "evidence" says what speaks against it: it is less plausible than was asked for, or its
    /// confidence is low over most of the surface.
    ISYM_OUTCOME_DOUBTFUL = 1,
    /// No map came near to a symmetry; the report says why.
    ISYM_OUTCOME_NONE = 2,
};
#ifndef __cplusplus
typedef int32_t isym_outcome;
#endif // __cplusplus

/// The kind of a symmetry.
enum isym_kind
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
    /// Reverses orientation: left and right are exchanged.
    ISYM_KIND_REFLECTION = 0,
    /// Keeps orientation and is its own inverse. It has no sides and no fixed curve.
    ISYM_KIND_HALF_TURN = 1,
};
#ifndef __cplusplus
typedef int32_t isym_kind;
#endif // __cplusplus

/// Which vertices take the value of their mirror image.
enum isym_merge
#ifdef __cplusplus
  : int32_t
#endif // __cplusplus
 {
    /// Every vertex: the two sides are exchanged. This is also how an attribute named "left" becomes "right".
    ISYM_MERGE_SWAP = 0,
    /// Every vertex takes the mean of its own and its image's value.
    ISYM_MERGE_AVERAGE = 1,
    /// Vertices with side -1 take it; side 1 stays, and so does the fixed curve.
    ISYM_MERGE_POSITIVE_WINS = 2,
    /// Vertices with side 1 take it; side -1 stays, and so does the fixed curve.
    ISYM_MERGE_NEGATIVE_WINS = 3,
};
#ifndef __cplusplus
typedef int32_t isym_merge;
#endif // __cplusplus

/// Eigenpairs of a mesh, from `isym_mesh_eigen`. They never change.
typedef struct isym_eigen isym_eigen;

/// A validated mesh. It never changes; any number of calls in any threads may use it at once.
typedef struct isym_mesh isym_mesh;

/// A set of options. Made with the defaults; one set may be used for any number of calls, from any thread.
typedef struct isym_options isym_options;

/// Progress of a call, and the way to cancel it. Make one for each call: once cancelled it stays so.
typedef struct isym_progress isym_progress;

/// What was found on a mesh: symmetries (reflections, best first, then half turns) and a report. It never changes.
typedef struct isym_result isym_result;

/// What a host needs to show an option.
typedef struct {
    /// `sizeof` of this struct, set by the caller before the call.
    size_t size;
    /// Name for `isym_options_set`. Never freed.
    const char *name;
    /// One sentence for dialogs, in English. Never freed.
    const char *help;
    /// Names of the values from 0 on, with `|` between them; NULL where values have none. Never freed.
    const char *choices;
    /// Value used when none is set. All values are whole numbers.
    double default_value;
    /// Smallest accepted value but for the default.
    double minimum;
    /// Largest accepted value.
    double maximum;
    /// 1 if only experts need it, otherwise 0.
    int32_t is_expert;
} isym_option_spec;

/// What a call reports to. It runs in the thread of that call.
///
/// @param stage Name of the stage: UTF-8, valid during this call.
/// @param fraction How much of the whole call is done, 0..=1; it never decreases.
/// @param user_data As given to `isym_progress_set_callback`.
/// @return 0 to go on; any other number cancels.
typedef int32_t (*isym_progress_callback)(const char *stage,
                                          double fraction,
                                          void *user_data);

/// Numbers of one symmetry as a whole.
typedef struct {
    /// `sizeof` of this struct, set by the caller before the call.
    size_t size;
    /// Reflection or half turn.
    isym_kind kind;
    /// How plausible it is, 0..=1, that it is a symmetry of the shape at all. The option "plausibility" says from where on one
    /// counts. A restored one has 1: it was accepted before.
    double plausibility;
    /// Lower is better; comparable between symmetries of one mesh.
    double score;
    /// Mean of the confidence over the surface, 0..=1.
    double mean_confidence;
    /// Share of the vertices whose partner comes from mirrored connectivity, an exact bijection; 0..=1.
    double exact_share;
    /// Share of the surface whose vertices have a partner, 0..=1.
    double paired_share;
    /// Shells (connected components) whose mirror image is another shell.
    size_t shells_paired;
    /// Shells that are their own mirror image.
    size_t shells_self_mirrored;
    /// Shells without a mirror image.
    size_t shells_alone;
} isym_summary;

/// How mirrored values meet the old ones.
typedef struct {
    /// `sizeof` of this struct, set by the caller before the call.
    size_t size;
    /// A half turn has no sides: only swap and average.
    isym_merge merge;
    /// Vertices with less confidence keep their value; 0..=1.
    float minimum_confidence;
    /// 0: trusted vertices change wholly. 1: each changes by the share of its confidence.
    int32_t weight_by_confidence;
} isym_mirroring;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/// The version of the library that is running; compare with `ISYM_VERSION`, that of the header.
///
/// @return Such as "0.1.0". Never NULL, never freed.
ISYM_API
const char *isym_version(void);

/// The name of a status in this header.
///
/// @param status Any number.
/// @return Such as "ISYM_ERROR_MESH"; "unknown status" for a number that is none. Never NULL, never freed.
ISYM_API
const char *isym_status_name(isym_status status);

/// What went wrong in the last call of this thread that returned a status.
///
/// @return A sentence in UTF-8, for people; empty if that call returned `ISYM_OK`. Never NULL. Valid until this thread's
/// next such call.
ISYM_API
const char *isym_error_message(void);

/// Number of options in the table.
///
/// @return One more than the largest index of `isym_option_describe`.
ISYM_API
size_t isym_option_count(void);

/// Describes an option.
///
/// @param index From 0 to below `isym_option_count()`.
/// @param[in,out] spec Its `size` is set before the call.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_SIZE`.
ISYM_API
isym_status isym_option_describe(size_t index,
                                 isym_option_spec *spec);

/// Makes a set of options with the defaults.
///
/// @param[out] options Free it with `isym_options_free`.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_options_new(isym_options **options);

/// Sets an option. On failure nothing changes.
///
/// @param options The set.
/// @param name The option's name, UTF-8.
/// @param value A whole number in the option's range.
/// @return `ISYM_OK`; `ISYM_ERROR_OPTION`: there is no such option, or `value` is outside its range.
ISYM_API
isym_status isym_options_set(isym_options *options,
                             const char *name,
                             double value);

/// Reads an option.
///
/// @param options The set; NULL for the defaults.
/// @param name The option's name, UTF-8.
/// @param[out] value Its value.
/// @return `ISYM_OK`; `ISYM_ERROR_OPTION`: there is no such option.
ISYM_API
isym_status isym_options_get(const isym_options *options,
                             const char *name,
                             double *value);

/// Takes a sign network (ONNX) of your own instead of the embedded one; it is trusted input.
///
/// It runs in the ONNX Runtime library (1.24 or newer) that the environment variable `ORT_DYLIB_PATH` names. Whether it can be
/// used shows when it is: `ISYM_ERROR_MODEL`.
///
/// @param options The set.
/// @param path The file, UTF-8. An empty text takes the embedded network again.
/// @return `ISYM_OK`, `ISYM_ERROR_TEXT`.
ISYM_API
isym_status isym_options_set_model(isym_options *options,
                                   const char *path);

/// Tells the signs that a person knows. They overrule the network; the last call counts.
///
/// @param options The set.
/// @param signs Of the first eigenfunctions of `isym_mesh_eigen`: 1 even, -1 odd, 0 unknown.
/// @param count Number of signs.
/// @return `ISYM_OK`; `ISYM_ERROR_OPTION`: a sign is another number.
ISYM_API
isym_status isym_options_set_known_signs(isym_options *options,
                                         const int8_t *signs,
                                         size_t count);

/// Frees a set of options.
///
/// @param options The set; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
ISYM_API
isym_status isym_options_free(isym_options *options);

/// Makes a progress without a callback.
///
/// @param[out] progress Free it with `isym_progress_free`.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_progress_new(isym_progress **progress);

/// Gives the function that later calls with this progress report to.
///
/// @param progress The progress.
/// @param callback A C++ exception thrown by it ends the call with `ISYM_ERROR_CALLBACK`.
/// @param user_data Handed to the callback; may be NULL.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_progress_set_callback(isym_progress *progress,
                                       isym_progress_callback callback,
                                       void *user_data);

/// Reads how much of the call that last reported here is done. From any thread.
///
/// @param progress The progress.
/// @param[out] fraction 0..=1.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_progress_fraction(const isym_progress *progress,
                                   double *fraction);

/// Cancels the running call, and every later one, with this progress. From any thread, also from the callback.
///
/// The call returns `ISYM_ERROR_CANCELLED` within half a second on a mesh of 100,000 vertices, whatever its form.
///
/// @param progress The progress.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_progress_cancel(isym_progress *progress);

/// Frees a progress. A call that runs with it goes on, and can no longer be cancelled.
///
/// @param progress The progress; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
ISYM_API
isym_status isym_progress_free(isym_progress *progress);

/// Makes a mesh of triangles. The arrays are copied.
///
/// Non-manifold edges, several shells, boundaries, inconsistent orientation, duplicate and degenerate faces and unreferenced
/// vertices are accepted (the report says what was repaired); numbers that are not finite, indices past the end, and a mesh
/// without any area are not.
///
/// @param positions x, y, z of each vertex, 3 * vertex_count numbers, any unit.
/// @param vertex_count Number of vertices, at most 5 million.
/// @param triangles 3 * triangle_count vertex numbers from 0.
/// @param triangle_count Number of triangles, at most 10 million.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return `ISYM_OK`, `ISYM_ERROR_MESH`, `ISYM_ERROR_LIMIT`.
ISYM_API
isym_status isym_mesh_from_triangles(const double *positions,
                                     size_t vertex_count,
                                     const uint32_t *triangles,
                                     size_t triangle_count,
                                     isym_mesh **mesh);

/// As `isym_mesh_from_triangles`, with single-precision positions.
///
/// @param positions x, y, z of each vertex, 3 * vertex_count numbers, any unit.
/// @param vertex_count Number of vertices.
/// @param triangles 3 * triangle_count vertex numbers from 0.
/// @param triangle_count Number of triangles.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return As `isym_mesh_from_triangles`.
ISYM_API
isym_status isym_mesh_from_triangles_f32(const float *positions,
                                         size_t vertex_count,
                                         const uint32_t *triangles,
                                         size_t triangle_count,
                                         isym_mesh **mesh);

/// As `isym_mesh_from_triangles`, for polygons of any size.
///
/// @param positions x, y, z of each vertex, 3 * vertex_count numbers, any unit.
/// @param vertex_count Number of vertices.
/// @param face_offsets face_count + 1 rising numbers from 0 to corner_count: the corners of face f are
/// `corners[face_offsets[f]]` to before `corners[face_offsets[f + 1]]`.
/// @param face_count Number of faces.
/// @param corners Vertex numbers from 0.
/// @param corner_count Number of corners of all faces.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return As `isym_mesh_from_triangles`.
ISYM_API
isym_status isym_mesh_from_polygons(const double *positions,
                                    size_t vertex_count,
                                    const uint32_t *face_offsets,
                                    size_t face_count,
                                    const uint32_t *corners,
                                    size_t corner_count,
                                    isym_mesh **mesh);

/// As `isym_mesh_from_polygons`, with single-precision positions.
///
/// @param positions x, y, z of each vertex, 3 * vertex_count numbers, any unit.
/// @param vertex_count Number of vertices.
/// @param face_offsets face_count + 1 rising numbers from 0 to corner_count: the corners of face f are
/// `corners[face_offsets[f]]` to before `corners[face_offsets[f + 1]]`.
/// @param face_count Number of faces.
/// @param corners Vertex numbers from 0.
/// @param corner_count Number of corners of all faces.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return As `isym_mesh_from_triangles`.
ISYM_API
isym_status isym_mesh_from_polygons_f32(const float *positions,
                                        size_t vertex_count,
                                        const uint32_t *face_offsets,
                                        size_t face_count,
                                        const uint32_t *corners,
                                        size_t corner_count,
                                        isym_mesh **mesh);

/// Reads a mesh from a PLY, OBJ, OFF, STL, glTF or GLB file.
///
/// @param path The file, UTF-8.
/// @param[out] mesh Free it with `isym_mesh_free`.
/// @return `ISYM_OK`; `ISYM_ERROR_FILE`: the text names the line or byte that is wrong; `ISYM_ERROR_MESH`,
/// `ISYM_ERROR_LIMIT`.
ISYM_API
isym_status isym_mesh_read(const char *path,
                           isym_mesh **mesh);

/// Reads what the mesh was made with.
///
/// @param mesh The mesh.
/// @param[out] vertex_count Number of vertices.
/// @param[out] face_count Number of faces.
/// @param[out] corner_count Number of corners of all faces.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_mesh_size(const isym_mesh *mesh,
                           size_t *vertex_count,
                           size_t *face_count,
                           size_t *corner_count);

/// Copies the vertices' positions out.
///
/// @param mesh The mesh.
/// @param[out] positions x, y, z of each vertex.
/// @param length 3 * vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_mesh_positions(const isym_mesh *mesh,
                                double *positions,
                                size_t length);

/// Copies the faces out, in the form of `isym_mesh_from_polygons`.
///
/// @param mesh The mesh.
/// @param[out] face_offsets Where the corners of each face begin, and their end.
/// @param offset_count Faces + 1.
/// @param[out] corners Vertex numbers from 0.
/// @param corner_count Number of corners of all faces.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_mesh_polygons(const isym_mesh *mesh,
                               uint32_t *face_offsets,
                               size_t offset_count,
                               uint32_t *corners,
                               size_t corner_count);

/// Reads a 64-bit hash of the connectivity: number of vertices, face sizes and corners, not the positions.
///
/// Equal for equal connectivity on every machine and in every version. Keep it beside a stored map: where it has changed, the
/// map is stale.
///
/// @param mesh The mesh.
/// @param[out] hash The hash.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_mesh_connectivity_hash(const isym_mesh *mesh,
                                        uint64_t *hash);

/// Finds the intrinsic symmetries of the mesh.
///
/// That none was found is a result without symmetries, and no error. The result keeps what it needs of the mesh, which may be
/// freed before it. One call uses at most as many threads as its options say; calls in several threads run side by side.
///
/// @param mesh The mesh.
/// @param options NULL for the defaults.
/// @param progress NULL: nothing is reported, and nobody can cancel.
/// @param[out] result Free it with `isym_result_free`.
/// @return `ISYM_OK`, `ISYM_ERROR_CANCELLED`, `ISYM_ERROR_CALLBACK`, `ISYM_ERROR_LIMIT`;
/// `ISYM_ERROR_MODEL`, with a sign network of your own.
ISYM_API
isym_status isym_mesh_detect(const isym_mesh *mesh,
                             const isym_options *options,
                             isym_progress *progress,
                             isym_result **result);

/// As `isym_mesh_detect`, starting from an earlier result on a mesh with the same connectivity and other positions: some seven
/// times as fast while the shape is deformed.
///
/// If the first symmetry of `previous` is still one, it is kept with all others that still are: partners, surface points,
/// confidences, sides and fixed curves as they were, scores and the report new (its `kept` is true). Otherwise, or if
/// `previous` has none, this is a detection, and the report says why. What is kept knows nothing of vertices that were slid
/// along the surface, on one side alone: detect anew after that.
///
/// A result that was not restored also holds what the call needs of the connectivity (some 1 MB, and 4 bytes a vertex), which
/// the new one shares: hand over the newest or the first, not a restored one, and the call takes half the time.
///
/// @param mesh The mesh as it is now.
/// @param previous May be restored, and may be freed after the call.
/// @param options NULL for the defaults.
/// @param progress NULL: nothing is reported, and nobody can cancel.
/// @param[out] result Free it with `isym_result_free`.
/// @return As `isym_mesh_detect`; `ISYM_ERROR_VALUE`: `previous` is of another connectivity (`isym_mesh_connectivity_hash`).
ISYM_API
isym_status isym_mesh_detect_again(const isym_mesh *mesh,
                                   const isym_result *previous,
                                   const isym_options *options,
                                   isym_progress *progress,
                                   isym_result **result);

/// Computes the lowest eigenpairs of the Laplace-Beltrami operator on the mesh's largest shell, the constant function left out.
///
/// @param mesh The mesh.
/// @param count How many, 1 to 1000.
/// @param progress NULL: nothing is reported, and nobody can cancel.
/// @param[out] eigenpairs Free them with `isym_eigen_free`.
/// @return `ISYM_OK`, `ISYM_ERROR_CANCELLED`, `ISYM_ERROR_CALLBACK`; `ISYM_ERROR_VALUE`: another count.
ISYM_API
isym_status isym_mesh_eigen(const isym_mesh *mesh,
                            size_t count,
                            isym_progress *progress,
                            isym_eigen **eigenpairs);

/// Frees a mesh. Results made from it, and calls that run with it, stay usable.
///
/// @param mesh The mesh; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
ISYM_API
isym_status isym_mesh_free(isym_mesh *mesh);

/// Reads what was found.
///
/// @param result The result.
/// @param[out] outcome `ISYM_OUTCOME_FOUND` for a restored result: it was accepted before.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_result_outcome(const isym_result *result,
                                isym_outcome *outcome);

/// Reads the number of symmetries that were found.
///
/// @param result The result.
/// @param[out] count A doubtful one counts; 0 if the mesh has none.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_result_symmetry_count(const isym_result *result,
                                       size_t *count);

/// Reads whether the mesh has a continuous family of symmetries, as a sphere, a torus or a vase has.
///
/// @param result The result.
/// @param[out] continuous_family 1: those found are arbitrary ones of infinitely many. 0: no; also for a restored result, where
/// nobody has looked.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_result_continuous_family(const isym_result *result,
                                          uint8_t *continuous_family);

/// Reads the numbers of a symmetry as a whole.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[in,out] summary Its `size` is set before the call.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_SIZE`.
ISYM_API
isym_status isym_result_summary(const isym_result *result,
                                size_t symmetry,
                                isym_summary *summary);

/// Copies the partner vertex of each vertex out.
///
/// Of several vertices in one place, as at seams, the partner is the one at the mirrored corner of the mirrored face. Where left
/// and right are not split alike, several vertices have one partner.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] partners `ISYM_NONE` for a vertex without partner, such as one that no face uses.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_result_partners(const isym_result *result,
                                 size_t symmetry,
                                 uint32_t *partners,
                                 size_t vertex_count);

/// Copies out how far each partner can be trusted.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] confidences The estimated probability, 0..=1, that the partner lies within 0.05 sqrt(area) of the true mirror image.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_result_confidences(const isym_result *result,
                                    size_t symmetry,
                                    float *confidences,
                                    size_t vertex_count);

/// Copies each vertex's side out.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] sides 1 and -1 on the two sides, 0 on the fixed curve, without partner, and everywhere for a half turn.
/// Which side is 1 has no meaning.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_result_sides(const isym_result *result,
                              size_t symmetry,
                              int8_t *sides,
                              size_t vertex_count);

/// Copies out the exact mirror image of each vertex, a point of the surface.
///
/// A vertex without partner has `ISYM_NONE` four times, and weights 0.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] faces vertex_count numbers of the faces that hold the images.
/// @param[out] corners 3 * vertex_count numbers of three vertices of that face, a triangle of it.
/// @param[out] barycentrics 3 * vertex_count weights of these, each 0..=1, summing to 1.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_result_surface_points(const isym_result *result,
                                       size_t symmetry,
                                       uint32_t *faces,
                                       uint32_t *corners,
                                       float *barycentrics,
                                       size_t vertex_count);

/// Copies out a colour for each vertex that its partner shares, and distinct pairs do not: the colours that the command line
/// writes. Grey where there is no partner or no confidence.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] colours 3 * vertex_count numbers: red, green, blue of each vertex, sRGB.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_result_pair_colours(const isym_result *result,
                                     size_t symmetry,
                                     uint8_t *colours,
                                     size_t vertex_count);

/// Reads the size of the fixed curve.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] line_count Number of lines; 0: there is no curve.
/// @param[out] point_count Number of points of all lines.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`.
ISYM_API
isym_status isym_result_curve_size(const isym_result *result,
                                   size_t symmetry,
                                   size_t *line_count,
                                   size_t *point_count);

/// Copies the fixed curve out: where the map leaves the surface in place.
///
/// With no line at all there is nothing to copy, and no need to call this. Point p lies at
/// (1 - t) * `edges[2 * p]` + t * `edges[2 * p + 1]`, where t is `parameters[p]`.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param[out] line_offsets line_count + 1 numbers; line l has the points from `line_offsets[l]` to before
/// `line_offsets[l + 1]`.
/// @param[out] closed line_count numbers, 1 where the last point joins the first, otherwise 0.
/// @param line_count That of `isym_result_curve_size`.
/// @param[out] edges 2 * point_count vertex numbers.
/// @param[out] parameters point_count numbers, 0..=1.
/// @param point_count That of `isym_result_curve_size`.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_result_curve(const isym_result *result,
                              size_t symmetry,
                              uint32_t *line_offsets,
                              uint8_t *closed,
                              size_t line_count,
                              uint32_t *edges,
                              float *parameters,
                              size_t point_count);

/// Reads the size of the report.
///
/// @param result The result.
/// @param[out] size Number of bytes, with the final NUL.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_result_report_size(const isym_result *result,
                                    size_t *size);

/// Copies the report out: the JSON that `intrinsym detect --json` writes.
///
/// @param result The result.
/// @param[out] report UTF-8, with a final NUL.
/// @param size That of `isym_result_report_size`.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_result_report(const isym_result *result,
                               char *report,
                               size_t size);

/// Makes a result with one symmetry from stored arrays, so that the tools work on a map that was kept with a mesh.
///
/// All arrays are in the form in which this library gave them. Positions may have changed since; the connectivity may not
/// (compare `isym_mesh_connectivity_hash`).
///
/// @param mesh The mesh.
/// @param kind Reflection or half turn.
/// @param partners vertex_count numbers; `ISYM_NONE` for none.
/// @param confidences vertex_count numbers, 0..=1.
/// @param sides vertex_count numbers: -1, 0 or 1.
/// @param faces vertex_count numbers.
/// @param corners 3 * vertex_count numbers.
/// @param barycentrics 3 * vertex_count numbers.
/// @param vertex_count Number of the mesh's vertices.
/// @param[out] result Free it with `isym_result_free`.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`; `ISYM_ERROR_VALUE`: an entry cannot be right, and the text names it.
ISYM_API
isym_status isym_result_restore(const isym_mesh *mesh,
                                isym_kind kind,
                                const uint32_t *partners,
                                const float *confidences,
                                const int8_t *sides,
                                const uint32_t *faces,
                                const uint32_t *corners,
                                const float *barycentrics,
                                size_t vertex_count,
                                isym_result **result);

/// Frees a result.
///
/// @param result The result; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
ISYM_API
isym_status isym_result_free(isym_result *result);

/// Mirrors a selection of vertices: selects those whose mirror image lies in it.
///
/// A vertex of a denser side selects its partner even where that stands for several.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param selected One byte per vertex, 0 or 1 (any other number counts as 1).
/// @param minimum_confidence Vertices with less, 0..=1, are not selected.
/// @param[out] mirrored One byte per vertex, 0 or 1; may be `selected`.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`; `ISYM_ERROR_OPTION`: a number is outside its range.
ISYM_API
isym_status isym_result_mirror_selection(const isym_result *result,
                                         size_t symmetry,
                                         const uint8_t *selected,
                                         float minimum_confidence,
                                         uint8_t *mirrored,
                                         size_t vertex_count);

/// Mirrors a selection of faces: selects those whose mirror image is selected.
///
/// Where connectivity is mirrored, faces go to their exact mirror images; elsewhere a face is selected if all its corners are
/// in the mirror image of the selected faces' corners.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param selected One byte per face that the mesh was made with, 0 or 1 (any other number counts as 1).
/// @param minimum_confidence Faces with a corner of less, 0..=1, are not selected.
/// @param[out] mirrored One byte per face, 0 or 1; may be `selected`.
/// @param face_count Number of the mesh's faces.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`; `ISYM_ERROR_OPTION`: a number is outside its range.
ISYM_API
isym_status isym_result_mirror_face_selection(const isym_result *result,
                                              size_t symmetry,
                                              const uint8_t *selected,
                                              float minimum_confidence,
                                              uint8_t *mirrored,
                                              size_t face_count);

/// Mirrors a vertex attribute of any number of components: weights, colours, masks, texture coordinates.
///
/// Vectors in space need `isym_result_carry_displacement` instead.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param mirroring Its `size` is set before the call.
/// @param values components * vertex_count numbers, those of one vertex side by side.
/// @param components Numbers of one vertex, 1 or more.
/// @param[out] mirrored As `values`; may be the same array.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`, `ISYM_ERROR_SIZE`, `ISYM_ERROR_VALUE`; `ISYM_ERROR_OPTION`: the
/// confidence is outside its range, or a half turn has no sides.
ISYM_API
isym_status isym_result_mirror_values(const isym_result *result,
                                      size_t symmetry,
                                      const isym_mirroring *mirroring,
                                      const double *values,
                                      size_t components,
                                      double *mirrored,
                                      size_t vertex_count);

/// Carries a displacement field across the map in local frames, so that it is right in any pose: a shape key, or an edit since a
/// remembered state. It is turned and stretched with the surface.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param mirroring Its `size` is set before the call.
/// @param positions x, y, z of each vertex of the shape that is displaced, in the pose it is in.
/// @param displacements x, y, z of each vertex, in any unit.
/// @param[out] carried As `displacements`; may be the same array.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`, `ISYM_ERROR_SIZE`, `ISYM_ERROR_VALUE`; `ISYM_ERROR_OPTION`: the
/// confidence is outside its range, or a half turn has no sides.
ISYM_API
isym_status isym_result_carry_displacement(const isym_result *result,
                                           size_t symmetry,
                                           const isym_mirroring *mirroring,
                                           const double *positions,
                                           const double *displacements,
                                           double *carried,
                                           size_t vertex_count);

/// Makes positions symmetric across the map in local frames: each side keeps its pose and takes the other's shape, or both the
/// mean of the two.
///
/// What is much smaller than the surface is carried whole; what is as large as a limb's pose stays. Solves one sparse system.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param mirroring Its `size` is set before the call.
/// @param positions x, y, z of each vertex, in any unit and pose.
/// @param progress NULL: nothing is reported, and nobody can cancel.
/// @param[out] symmetrized As `positions`; may be the same array.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`, `ISYM_ERROR_SIZE`, `ISYM_ERROR_VALUE`; `ISYM_ERROR_OPTION`: the
/// confidence is outside its range, or a half turn has no sides. Also
/// `ISYM_ERROR_CANCELLED`, `ISYM_ERROR_CALLBACK`.
ISYM_API
isym_status isym_result_symmetrize_positions(const isym_result *result,
                                             size_t symmetry,
                                             const isym_mirroring *mirroring,
                                             const double *positions,
                                             isym_progress *progress,
                                             double *symmetrized,
                                             size_t vertex_count);

/// Measures how far each vertex is from the fixed curve, along the surface.
///
/// @param result The result.
/// @param symmetry From 0, the best first.
/// @param positions x, y, z of each vertex, in any unit and pose.
/// @param[out] distances vertex_count numbers in that unit; infinite where the curve cannot be reached: on other shells, without a
/// curve, and with a result from `isym_result_restore`, which has none.
/// @param vertex_count Number of the mesh's vertices.
/// @return `ISYM_OK`, `ISYM_ERROR_INDEX`, `ISYM_ERROR_LENGTH`; `ISYM_ERROR_VALUE`: a position is not finite.
ISYM_API
isym_status isym_result_curve_distances(const isym_result *result,
                                        size_t symmetry,
                                        const double *positions,
                                        double *distances,
                                        size_t vertex_count);

/// Reads the numbers of vertices and of eigenpairs.
///
/// @param eigenpairs The eigenpairs.
/// @param[out] vertex_count Number of the mesh's vertices.
/// @param[out] count Number of eigenpairs: fewer than asked for on a tiny mesh.
/// @return `ISYM_OK`, or an error that any call has.
ISYM_API
isym_status isym_eigen_size(const isym_eigen *eigenpairs,
                            size_t *vertex_count,
                            size_t *count);

/// Copies the eigenpairs out. The sign of a function has no meaning.
///
/// @param eigenpairs The eigenpairs.
/// @param[out] eigenvalues `count` numbers, ascending, in units of 1 / area of the largest shell.
/// @param[out] eigenfunctions vertex_count * count numbers, those of one vertex side by side; orthonormal in the mass; NaN where
/// the vertex is not on the largest shell.
/// @param[out] mass vertex_count numbers that sum to 1; 0 where the vertex is not on that shell.
/// @param vertex_count That of `isym_eigen_size`.
/// @param count That of `isym_eigen_size`.
/// @return `ISYM_OK`, `ISYM_ERROR_LENGTH`.
ISYM_API
isym_status isym_eigen_read(const isym_eigen *eigenpairs,
                            double *eigenvalues,
                            double *eigenfunctions,
                            double *mass,
                            size_t vertex_count,
                            size_t count);

/// Frees eigenpairs.
///
/// @param eigenpairs The eigenpairs; NULL is fine.
/// @return `ISYM_OK`, `ISYM_ERROR_HANDLE`.
ISYM_API
isym_status isym_eigen_free(isym_eigen *eigenpairs);

/// How many handles of all kinds are live. For leak checks in tests.
///
/// @return 0 when everything was freed.
ISYM_API
size_t isym_handle_count(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* INTRINSYM_ISYM_H */
