/* How a function is made visible outside a shared library. */
#ifndef DYNOID_EXPORT_H
#define DYNOID_EXPORT_H

#if defined _WIN32
#define DYNOID_EXPORT __declspec(dllexport)
#elif defined __GNUC__
#define DYNOID_EXPORT __attribute__((visibility("default")))
#else
#define DYNOID_EXPORT
#endif

#endif
