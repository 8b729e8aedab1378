// The one file of this suite that holds doctest itself and its main().
#include "../report.h"
