/* What of a module compiled with -fsanitize-coverage=trace-pc an input has reached. */
#include <stdint.h>
#include <string.h>

#define SIZE 65536

static unsigned char reached[SIZE];

void __sanitizer_cov_trace_pc(void) {
    uintptr_t place = (uintptr_t)__builtin_return_address(0);
    unsigned char *count = &reached[(place ^ (place >> 16)) % SIZE];
    if (*count < 255) (*count)++;
}

void forget(void) { memset(reached, 0, SIZE); }

/* Writes the places that were reached, each with how often in powers of two; returns how many. */
int reached_places(int *places) {
    int found = 0;
    for (int i = 0; i < SIZE; i++)
        if (reached[i]) places[found++] = i * 8 + (31 - __builtin_clz(reached[i]));
    return found;
}
