package org.fieldwalk.survey

import android.content.ContentProvider
import android.content.ContentValues
import android.content.Context
import android.content.Intent
import android.database.Cursor
import android.database.MatrixCursor
import android.net.Uri
import android.os.ParcelFileDescriptor
import android.provider.OpenableColumns
import java.io.File
import java.io.FileNotFoundException

/** Gives the map and the recordings to the app that the surveyor shares them with, to read and nothing else. */
class ExportProvider : ContentProvider() {
    override fun onCreate() = true

    override fun openFile(uri: Uri, mode: String): ParcelFileDescriptor =
        ParcelFileDescriptor.open(file(uri), ParcelFileDescriptor.MODE_READ_ONLY)

    override fun getType(uri: Uri) = "application/octet-stream"

    override fun query(
        uri: Uri, columns: Array<String>?, selection: String?, arguments: Array<String>?, order: String?,
    ): Cursor {
        val file = file(uri)
        val wanted = columns ?: arrayOf(OpenableColumns.DISPLAY_NAME, OpenableColumns.SIZE)
        return MatrixCursor(wanted).apply {
            addRow(
                wanted.map { column ->
                    when (column) {
                        OpenableColumns.DISPLAY_NAME -> uri.getQueryParameter(NAME) ?: file.name
                        OpenableColumns.SIZE -> file.length()
                        else -> null
                    }
                },
            )
        }
    }

    override fun insert(uri: Uri, values: ContentValues?): Uri? = null

    override fun update(uri: Uri, values: ContentValues?, selection: String?, arguments: Array<String>?) = 0

    override fun delete(uri: Uri, selection: String?, arguments: Array<String>?) = 0

    private fun file(uri: Uri): File {
        val (survey, name) = uri.pathSegments.takeIf { it.size == 2 } ?: throw FileNotFoundException(uri.toString())
        // By name among those that are shared, so that no path leads elsewhere.
        return CurrentSurvey.folder(requireContext(), survey)?.toShare()?.firstOrNull { it.name == name }
            ?: throw FileNotFoundException(uri.toString())
    }

    companion object {
        private const val NAME = "name"

        /** What opens the share sheet with the map and all recordings of the survey. */
        fun share(context: Context, survey: SurveyFolder): Intent {
            val uris = survey.toShare().map { file ->
                Uri.Builder().scheme("content").authority("${context.packageName}.export").appendPath(survey.name)
                    .appendPath(file.name).appendQueryParameter(NAME, exportName(survey.floor, file.name)).build()
            }
            val send = Intent(Intent.ACTION_SEND_MULTIPLE).setType("application/octet-stream")
                .putParcelableArrayListExtra(Intent.EXTRA_STREAM, ArrayList(uris))
                .addFlags(Intent.FLAG_GRANT_READ_URI_PERMISSION)
            return Intent.createChooser(send, null)
        }
    }
}

/** The name of an exported file: of the floor, with nothing that a file system or a colleague would stumble over. */
fun exportName(floor: String, file: String): String {
    val words = floor.split(Regex("[^A-Za-z0-9]+")).filter { it.isNotEmpty() }
    return words.ifEmpty { listOf("floor") }.joinToString("-") + "." + file
}
