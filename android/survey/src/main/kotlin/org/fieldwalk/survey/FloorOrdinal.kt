package org.fieldwalk.survey

/**
 * The floor's number by its name, as the engine's `floor_ordinal` takes it from recordings: `F1`, `1F`, `L1` and `G` are
 * the ground floor, 0; `B1` is -1. A name that says nothing gives 0.
 */
fun floorOrdinal(floor: String): Int {
    val name = floor.trim().map { if (it in 'a'..'z') it - ('a' - 'A') else it }.joinToString("")
    val digits = name.dropWhile { it !in '0'..'9' }.takeWhile { it in '0'..'9' }
    val number = digits.ifEmpty { null }?.let { it.toIntOrNull() ?: Int.MAX_VALUE }
    val isBelow = name.startsWith('B') || name.startsWith('-') || name.startsWith("LG")
    return when {
        number != null && (isBelow || name.startsWith('P')) -> -number
        number != null -> maxOf(number - 1, 0)
        isBelow -> -1
        else -> 0
    }
}

/** What the start screen offers. */
val FLOOR_ORDINALS = -20..200
