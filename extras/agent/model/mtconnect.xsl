<?xml version="1.0" encoding="UTF-8"?>
<xsl:stylesheet version="1.0" xmlns:xsl="http://www.w3.org/1999/XSL/Transform">
<xsl:output method="html" encoding="UTF-8" doctype-system="about:legacy-compat"/>
<xsl:template match="/">
<html lang="en"><head><title>MTConnect</title><meta name="viewport" content="width=device-width"/>
<style>
:root{color-scheme:light dark}
body{font:15px/1.45 system-ui,sans-serif;margin:1.5rem;max-width:70rem}
table{border-collapse:collapse;margin:.5rem 0 1.5rem;width:100%}
th,td{text-align:left;padding:.2rem .7rem;border-bottom:1px solid #8884}
td.v{font-variant-numeric:tabular-nums;font-weight:600}
nav a{margin-right:1rem} small,th{color:#777;font-weight:400}
</style></head><body>
<nav><a href="probe">probe</a><a href="current">current</a><a href="sample">sample</a>
<a href="assets">assets</a></nav>
<xsl:apply-templates select="*/*[local-name()!='Header']"/>
</body></html></xsl:template>
<xsl:template match="*[local-name()='Devices']">
<xsl:for-each select="*">
<h1><xsl:value-of select="@name"/><xsl:text> </xsl:text>
<small><xsl:value-of select="*[local-name()='Description']"/></small></h1>
<table><tr><th>component</th><th>id</th><th>name</th><th>type</th><th>sub type</th><th>category</th>
<th>units</th></tr>
<xsl:for-each select=".//*[local-name()='DataItem']"><tr>
<td><xsl:value-of select="local-name(../..)"/><xsl:text> </xsl:text>
<xsl:value-of select="../../@name"/></td><td><xsl:value-of select="@id"/></td>
<td><xsl:value-of select="@name"/></td><td><xsl:value-of select="@type"/></td>
<td><xsl:value-of select="@subType"/></td><td><xsl:value-of select="@category"/></td>
<td><xsl:value-of select="@units"/></td></tr></xsl:for-each></table>
</xsl:for-each></xsl:template>
<xsl:template match="*[local-name()='Streams']">
<xsl:for-each select="*"><h1><xsl:value-of select="@name"/></h1>
<table><tr><th>component</th><th>id</th><th>type</th><th>value</th><th>time</th><th>sequence</th></tr>
<xsl:for-each select="*/*/*"><tr>
<td><xsl:value-of select="../../@component"/><xsl:text> </xsl:text>
<xsl:value-of select="../../@name"/></td><td><xsl:value-of select="@dataItemId"/></td>
<td><xsl:value-of select="local-name()"/><xsl:text> </xsl:text><xsl:value-of select="@type"/>
<xsl:text> </xsl:text><xsl:value-of select="@subType"/></td><td class="v"><xsl:value-of select="."/></td>
<td><xsl:value-of select="@timestamp"/></td><td><xsl:value-of select="@sequence"/></td>
</tr></xsl:for-each></table></xsl:for-each></xsl:template>
<xsl:template match="*[local-name()='Errors']"><h1>Error</h1>
<xsl:for-each select="*"><p><b><xsl:value-of select="local-name()"/><xsl:value-of select="@errorCode"/>
</b><xsl:text> </xsl:text><xsl:value-of select="."/></p></xsl:for-each></xsl:template>
<xsl:template match="*[local-name()='Assets']"><h1>Assets</h1><table>
<tr><th>asset</th><th>kind</th><th>time</th><th>content</th></tr><xsl:for-each select="*"><tr>
<td><xsl:value-of select="@assetId"/></td><td><xsl:value-of select="local-name()"/></td>
<td><xsl:value-of select="@timestamp"/></td><td><xsl:value-of select="."/></td></tr></xsl:for-each>
</table></xsl:template>
</xsl:stylesheet>
