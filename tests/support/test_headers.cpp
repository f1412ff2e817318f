// Only there so that test_headers.h is compiled once.
