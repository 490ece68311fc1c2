// A panic of the library's own comes back as a status with its text, and the library goes on working.
#include "test.h"

isym_status isym_test_panic(void);

int main(void) {
    EXPECT(isym_test_panic() == ISYM_ERROR_INTERNAL);
    EXPECT(strcmp(isym_error_message(), "internal error, please report it: provoked by a test") == 0);
    isym_options *options;
    OK(isym_options_new(&options));
    EXPECT(strcmp(isym_error_message(), "") == 0);
    OK(isym_options_free(options));
    return 0;
}
