// What support/catch.hpp and the precompiled headers of the tests are compiled with.
