package org.fieldwalk.survey

/** The views' numbers: fixed, so that Android keeps their state over a rotation. */
object SurveyIds {
    const val PLAN = 1
    const val SUMMARY = 2
    const val ADVICE = 3
    const val MESSAGE = 4
    const val ACCURACY = 5
    const val BEGIN = 10
    const val END = 11
    const val PAUSE = 12
    const val RESUME = 13
    const val UNDO_TAP = 14
    const val UNDO_WALK = 15
    const val BUILD = 16
    const val CHECK = 17
    const val SHARE = 18
    const val CHOOSE_PLAN = 30
    const val ORDINAL = 31
    const val FLOOR_NAME = 32
    const val LOWER = 33
    const val HIGHER = 34
    const val SURVEYS = 35

    /** One for each survey, counted from here. */
    const val CONTINUE = 1000
    const val DELETE = 2000
}
