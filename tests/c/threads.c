// Several threads at once, handles freed under a running call, and cancellation: how long it takes is printed.
// ./threads human.ply quadruped.ply
#define _POSIX_C_SOURCE 200809L
#include "test.h"

#include <pthread.h>
#include <time.h>

// Longest time from cancel to return that is accepted here, where other tests run too; the time that an idle
// machine takes is in docs/c_library.md.
static const double LONGEST_ANSWER = 2.0;

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

struct job {
    const isym_mesh *mesh;
    isym_progress *progress;
    isym_status status;
    char message[128];
    uint32_t *partners;
    size_t vertices;
    double finished;
};

static void *detect(void *argument) {
    struct job *job = argument;
    isym_options *options;
    isym_result *result;
    OK(isym_options_new(&options));
    job->status = isym_mesh_detect(job->mesh, options, job->progress, &result);
    job->finished = now();
    snprintf(job->message, sizeof job->message, "%s", isym_error_message());
    if (job->status == ISYM_OK) {
        OK(isym_result_partners(result, 0, job->partners, job->vertices));
        OK(isym_result_free(result));
    }
    OK(isym_options_free(options));
    return NULL;
}

static struct job new_job(const isym_mesh *mesh) {
    struct job job = {.mesh = mesh};
    size_t faces, corners;
    OK(isym_mesh_size(mesh, &job.vertices, &faces, &corners));
    job.partners = malloc(job.vertices * sizeof *job.partners);
    OK(isym_progress_new(&job.progress));
    return job;
}

static void end_job(struct job *job) {
    free(job->partners);
    OK(isym_progress_free(job->progress));
}

// Two threads on one mesh, one on another; the shared mesh is freed while they run. One answer for one mesh.
static void at_once(const char *path, const char *other_path) {
    isym_mesh *mesh = read_mesh(path), *other = read_mesh(other_path);
    struct job jobs[3] = {new_job(mesh), new_job(mesh), new_job(other)};
    pthread_t threads[3];
    for (int i = 0; i < 3; ++i)
        EXPECT(pthread_create(&threads[i], NULL, detect, &jobs[i]) == 0);
    double fraction = 0;
    while (fraction < 0.05)
        OK(isym_progress_fraction(jobs[0].progress, &fraction));
    while (fraction < 0.05)
        OK(isym_progress_fraction(jobs[1].progress, &fraction));
    OK(isym_mesh_free(mesh));
    for (int i = 0; i < 3; ++i) {
        EXPECT(pthread_join(threads[i], NULL) == 0);
        // A thread that came to the mesh after it was freed would have been told so.
        EXPECT(jobs[i].status == ISYM_OK || (i == 1 && jobs[i].status == ISYM_ERROR_HANDLE));
    }
    if (jobs[1].status == ISYM_OK)
        EXPECT(memcmp(jobs[0].partners, jobs[1].partners, jobs[0].vertices * sizeof(uint32_t)) == 0);
    for (int i = 0; i < 3; ++i)
        end_job(&jobs[i]);
    OK(isym_mesh_free(other));
}

// Cancels at ever later fractions.
static void cancelled(const char *path) {
    isym_mesh *mesh = read_mesh(path);
    double longest = 0;
    int answered = 0;
    for (double at = 0; at < 1; at += 0.12) {
        struct job job = new_job(mesh);
        pthread_t thread;
        double fraction = 0;
        EXPECT(pthread_create(&thread, NULL, detect, &job) == 0);
        while (fraction < at)
            OK(isym_progress_fraction(job.progress, &fraction));
        const double asked = now();
        OK(isym_progress_cancel(job.progress));
        EXPECT(pthread_join(thread, NULL) == 0);
        EXPECT(job.status == ISYM_ERROR_CANCELLED || job.status == ISYM_OK);
        if (job.status == ISYM_ERROR_CANCELLED) {
            EXPECT(strcmp(job.message, "cancelled") == 0);
            const double took = job.finished - asked;
            printf("cancelled at %.2f: answered after %.0f ms\n", at, 1e3 * took);
            longest = took > longest ? took : longest;
            ++answered;
        }
        end_job(&job);
    }
    printf("longest answer %.0f ms\n", 1e3 * longest);
    EXPECT(answered > 4 && longest < LONGEST_ANSWER);
    OK(isym_mesh_free(mesh));
}

static int32_t stop(const char *stage, double fraction, void *user_data) {
    (void)stage;
    return fraction >= *(double *)user_data;
}

static void stopped_by_the_callback(const char *path) {
    isym_mesh *mesh = read_mesh(path);
    struct job job = new_job(mesh);
    double at = 0.3;
    OK(isym_progress_set_callback(job.progress, stop, &at));
    detect(&job);
    EXPECT(job.status == ISYM_ERROR_CANCELLED);
    end_job(&job);
    OK(isym_mesh_free(mesh));
}

// Each thread reads the text of its own last call.
static void *fail_often(void *argument) {
    char name[32];
    isym_options *options;
    OK(isym_options_new(&options));
    snprintf(name, sizeof name, "thread_%d", *(int *)argument);
    for (int i = 0; i < 2000; ++i) {
        EXPECT(isym_options_set(options, name, 1) == ISYM_ERROR_OPTION);
        EXPECT(strstr(isym_error_message(), name));
    }
    OK(isym_options_free(options));
    return NULL;
}

static void texts(void) {
    pthread_t threads[4];
    int numbers[4] = {0, 1, 2, 3};
    for (int i = 0; i < 4; ++i)
        EXPECT(pthread_create(&threads[i], NULL, fail_often, &numbers[i]) == 0);
    for (int i = 0; i < 4; ++i)
        EXPECT(pthread_join(threads[i], NULL) == 0);
}

int main(int count, char **arguments) {
    EXPECT(count == 3);
    texts();
    stopped_by_the_callback(arguments[2]);
    at_once(arguments[1], arguments[2]);
    cancelled(arguments[2]);
    EXPECT(isym_handle_count() == 0);
    return 0;
}
