// Does what the sanitizers must notice; where this ends well they are not in.
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Apart, so that the compiler does not know how long the array is.
__attribute__((noinline)) static void write_at(volatile char *bytes, int place) { bytes[place] = 1; }

int main(int count, char **arguments) {
    const char *mistake = count > 1 ? arguments[1] : "";
    if (strcmp(mistake, "past_the_end") == 0) {
        char *bytes = malloc(4);
        write_at(bytes, count + 2);
        free(bytes);
    } else if (strcmp(mistake, "overflow") == 0) {
        volatile int large = INT_MAX;
        large = large + count;
    } else if (strcmp(mistake, "leak") == 0) {
        void *volatile lost = malloc(8);
        lost = NULL;
        (void)lost;
    }
    puts("nothing was noticed");
    return 0;
}
