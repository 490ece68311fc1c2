// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef INTRINSYM_MESHLAB_TEST_H
#define INTRINSYM_MESHLAB_TEST_H

#include <cstdio>
#include <cstdlib>

#define EXPECT(condition)                                                                                             \
  do {                                                                                                                \
    if (!(condition)) {                                                                                               \
      std::fprintf(stderr, "%s:%d: not so: %s\n", __FILE__, __LINE__, #condition);                                    \
      std::exit(1);                                                                                                   \
    }                                                                                                                 \
  } while (false)

#endif
