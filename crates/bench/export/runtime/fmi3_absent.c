/* The functions of FMI 3.0 for what this model does not have: other types of variables, clocks, event indicators,
 * dependencies of elements, derivatives of outputs, and Scheduled Execution. They must exist. For no variable they
 * succeed; else they say what is missing. */
#include "fmi3_component.h"

static fmi3Status absent(fmi3Instance c, size_t count, const char *message) {
    if (!c) return fmi3Error;
    return count == 0 ? fmi3OK : (fmi3Status)fail(fmi3_instance(c), message);
}

#define WITHOUT(type)                                                                                                  \
    fmi3Status FMI3(fmi3Get##type)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3##type values[],       \
                                   size_t count) {                                                                     \
        (void)vr, (void)values;                                                                                        \
        return absent(c, n + count, "there are no variables of the type " #type);                                      \
    }                                                                                                                  \
    fmi3Status FMI3(fmi3Set##type)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3##type values[], \
                                   size_t count) {                                                                     \
        (void)vr, (void)values;                                                                                        \
        return absent(c, n + count, "there are no variables of the type " #type);                                      \
    }

WITHOUT(Float32)
WITHOUT(Int8)
WITHOUT(UInt8)
WITHOUT(Int16)
WITHOUT(UInt16)
WITHOUT(UInt32)
WITHOUT(UInt64)
WITHOUT(String)

fmi3Status FMI3(fmi3SetBoolean)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Boolean values[],
                                size_t count) {
    (void)vr, (void)values;
    return absent(c, n + count, "no Boolean variable can be set");
}

fmi3Status FMI3(fmi3GetBinary)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[],
                               fmi3Binary values[], size_t count) {
    (void)vr, (void)sizes, (void)values;
    return absent(c, n + count, "there are no variables of the type Binary");
}

fmi3Status FMI3(fmi3SetBinary)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const size_t sizes[],
                               const fmi3Binary values[], size_t count) {
    (void)vr, (void)sizes, (void)values;
    return absent(c, n + count, "there are no variables of the type Binary");
}

/* ---- clocks -------------------------------------------------------------------------------------------------- */

static const char NO_CLOCKS[] = "there are no clocks";

fmi3Status FMI3(fmi3GetClock)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Clock values[]) {
    (void)vr, (void)values;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3SetClock)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Clock values[]) {
    (void)vr, (void)values;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3GetIntervalDecimal)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 intervals[],
                                        fmi3IntervalQualifier qualifiers[]) {
    (void)vr, (void)intervals, (void)qualifiers;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3GetIntervalFraction)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                         fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[]) {
    (void)vr, (void)counters, (void)resolutions, (void)qualifiers;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3GetShiftDecimal)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Float64 shifts[]) {
    (void)vr, (void)shifts;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3GetShiftFraction)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3UInt64 counters[],
                                      fmi3UInt64 resolutions[]) {
    (void)vr, (void)counters, (void)resolutions;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3SetIntervalDecimal)(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                        const fmi3Float64 intervals[]) {
    (void)vr, (void)intervals;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3SetIntervalFraction)(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                         const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]) {
    (void)vr, (void)counters, (void)resolutions;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3SetShiftDecimal)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Float64 shifts[]) {
    (void)vr, (void)shifts;
    return absent(c, n, NO_CLOCKS);
}

fmi3Status FMI3(fmi3SetShiftFraction)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3UInt64 counters[],
                                      const fmi3UInt64 resolutions[]) {
    (void)vr, (void)counters, (void)resolutions;
    return absent(c, n, NO_CLOCKS);
}

/* ---- the rest ------------------------------------------------------------------------------------------------ */

fmi3Status FMI3(fmi3GetNumberOfVariableDependencies)(fmi3Instance c, fmi3ValueReference vr, size_t *count) {
    (void)vr, (void)count;
    return absent(c, 1, "dependencies are in the model description; there are none of elements");
}

fmi3Status FMI3(fmi3GetVariableDependencies)(fmi3Instance c, fmi3ValueReference dependent, size_t elements[],
                                             fmi3ValueReference independents[], size_t others[],
                                             fmi3DependencyKind kinds[], size_t count) {
    (void)dependent, (void)elements, (void)independents, (void)others, (void)kinds;
    return absent(c, count + 1, "dependencies are in the model description; there are none of elements");
}

fmi3Status FMI3(fmi3GetEventIndicators)(fmi3Instance c, fmi3Float64 indicators[], size_t count) {
    (void)indicators;
    return absent(c, count, "there are no event indicators");
}

fmi3Status FMI3(fmi3GetOutputDerivatives)(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Int32 orders[],
                                          fmi3Float64 values[], size_t count) {
    (void)vr, (void)orders, (void)values;
    return absent(c, n + count, "there are no derivatives of outputs");
}

fmi3Status FMI3(fmi3ActivateModelPartition)(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time) {
    (void)clock, (void)time;
    return absent(c, 1, "the model has no Scheduled Execution");
}
