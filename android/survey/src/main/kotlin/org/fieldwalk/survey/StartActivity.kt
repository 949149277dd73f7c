package org.fieldwalk.survey

import android.app.Activity
import android.content.Intent
import android.net.Uri
import android.os.Build
import android.os.Bundle
import android.view.View
import android.view.WindowInsets
import android.widget.EditText
import android.widget.LinearLayout
import android.widget.TextView
import org.fieldwalk.ApiException
import org.fieldwalk.Surveyor
import org.fieldwalk.android.Permissions
import java.io.IOException

/** Which floor is surveyed, on which plan. */
class StartActivity : Activity() {
    private lateinit var name: EditText
    private lateinit var message: TextView

    override fun onCreate(saved: Bundle?) {
        setTheme(android.R.style.Theme_DeviceDefault_DayNight)
        super.onCreate(saved)
        val texts = texts()
        title = texts.title
        name = EditText(this).apply {
            id = SurveyIds.FLOOR_NAME
            hint = texts.floorName
            setText(saved?.getString(NAME) ?: "F1")
            isSingleLine = true
        }
        message = label(SurveyIds.MESSAGE, 16f, isUrgent = true)
        val rows = mutableListOf(
            label(SurveyIds.SUMMARY, 24f).apply { text = texts.title },
            label(SurveyIds.ADVICE, 14f).apply {
                text = texts.floorName
                labelFor = SurveyIds.FLOOR_NAME
            },
            name,
            button(SurveyIds.CHOOSE_PLAN, texts.choosePlan, ::choose).apply { tag = null },
        )
        if (CurrentSurvey.folder(this).isSurvey) {
            rows.add(button(SurveyIds.CONTINUE, texts.continueSurvey, ::survey).apply { tag = null })
        }
        rows.add(message)
        setContentView(screen(*rows.toTypedArray()))
        requestPermissions(Permissions.forBeacons().toTypedArray(), 0)
    }

    override fun onSaveInstanceState(state: Bundle) {
        super.onSaveInstanceState(state)
        state.putString(NAME, name.text.toString())
    }

    @Deprecated("Android's own way without androidx")
    override fun onActivityResult(request: Int, result: Int, choice: Intent?) {
        val plan = choice?.data
        if (result == RESULT_OK && plan != null) open(plan)
    }

    private fun choose() {
        // Many apps that keep files know no type for GeoJSON.
        val choose = Intent(Intent.ACTION_OPEN_DOCUMENT).addCategory(Intent.CATEGORY_OPENABLE).setType("*/*")
        @Suppress("DEPRECATION") startActivityForResult(choose, 0)
    }

    private fun open(plan: Uri) {
        val floor = name.text.toString().ifBlank { "F1" }
        message.text = try {
            val bytes = contentResolver.openInputStream(plan)?.use { it.readBytes() } ?: ByteArray(0)
            // A plan that cannot be read must not drop the survey that is on.
            Surveyor(bytes.toDirect(), floor, 0).close()
            CurrentSurvey.begin(this, bytes, floor)
            survey()
            ""
        } catch (_: ApiException) {
            texts().planUnreadable
        } catch (_: IOException) {
            texts().planUnreadable
        }
    }

    private fun survey() = startActivity(Intent(this, SurveyActivity::class.java))

    private companion object {
        const val NAME = "name"
    }
}

/** A column that keeps clear of the bars that Android draws over it. */
internal fun Activity.screen(vararg views: View): LinearLayout =
    box(LinearLayout.VERTICAL, *views).apply {
        setOnApplyWindowInsetsListener { view, insets ->
            if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.R) {
                val bars = insets.getInsets(WindowInsets.Type.systemBars() or WindowInsets.Type.displayCutout())
                view.setPadding(bars.left, bars.top, bars.right, bars.bottom)
            } else {
                @Suppress("DEPRECATION")
                view.setPadding(0, insets.systemWindowInsetTop, 0, insets.systemWindowInsetBottom)
            }
            insets
        }
    }
