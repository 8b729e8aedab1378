/* What the public C headers of all libraries share. */
#ifndef TILENCA_API_H
#define TILENCA_API_H

/* Marks every function that a library exports; all else in it is hidden. */
#define TILENCA_API __attribute__((visibility("default")))

#endif
