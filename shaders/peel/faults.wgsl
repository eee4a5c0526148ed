// What the checks of a frame count. Anything but 0 is a bug of ours or of the driver, and an error.
struct Faults {
    // Fragments that do not come before the next one of their pixel.
    unsorted: atomic<u32>,
    // Fragments that were counted and not stored.
    lost: atomic<u32>,
    // Fragments that were stored and not counted.
    uncounted: atomic<u32>,
    // The last pixel where anything is wrong, + 1.
    pixel: atomic<u32>,
}
